//! `volgraph stress` and `volgraph advise`.

use super::Scratch;

#[test]
fn a_breaking_point_comes_as_a_table_and_a_page() {
    let scratch = Scratch::new();
    let drawn = scratch.run(&["stress", "--filter", "cut-through", "-o", "page"]);
    assert_eq!(drawn.code, Some(0), "{}{}", drawn.stdout, drawn.stderr);
    assert!(drawn.stdout.contains("fails, as known"), "{}", drawn.stdout);
    let page = std::fs::read_to_string(scratch.path().join("page/index.html")).unwrap();
    assert!(page.contains("cut-through-samples") && page.contains("<svg"));
    let pictures: Vec<&str> = page.split("src=\"").skip(1).collect();
    // The truth, and of two methods what was drawn and its errors.
    assert_eq!(pictures.len(), 5);
    for picture in pictures {
        let name = picture.split('"').next().unwrap();
        assert!(scratch.path().join("page").join(name).is_file(), "{name}");
    }
    let unknown = scratch.run(&["stress", "--filter", "no such case"]);
    assert_eq!(unknown.code, Some(1));
    assert!(unknown.stderr.contains("no-case"), "{}", unknown.stderr);
}

#[test]
fn a_graph_gets_its_advice_without_an_adapter() {
    let scratch = Scratch::new();
    let told = scratch.run(&["advise", "quickstart", "--json"]);
    assert_eq!(told.code, Some(0), "{}", told.stderr);
    let told: serde_json::Value = serde_json::from_str(&told.stdout).unwrap();
    let step = |rule: &str| told[rule]["step"].as_f64().unwrap();
    // The largest gradient asks for more than what all but a thousandth of the voxels have.
    assert!(step("by_largest_gradient") <= step("by_common_gradient"));
    assert!((0.01..10.0).contains(&step("by_spectra")));
    assert!(told["advice"].as_str().unwrap().ends_with('.'));
}
