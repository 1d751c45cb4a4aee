//! Pictures with layers that are rendered again: whatever one of the two has alone is a difference.

use volgraph::Picture;
use volgraph_picture::{Layer, LayerValues, SaveOptions};

use super::scene;

#[test]
fn layers_that_differ_or_are_in_one_alone_are_seen() {
    let scratch = scene();
    // The sides of the picture see past the volume.
    let args = ["render", "graph.ron", "-o", "a.exr", "--size", "24x8"];
    scratch.run(&args).ok();
    let whole = Picture::load(&scratch.path().join("a.exr")).unwrap();
    let depth = whole.depth.clone().unwrap();
    let hit = depth.iter().position(|depth| depth.is_finite()).unwrap();
    let missed = depth.iter().position(|it| !it.is_finite()).unwrap();
    let verify = |name: &str, change: &dyn Fn(&mut Picture)| {
        let mut picture = whole.clone();
        change(&mut picture);
        let file = scratch.path().join(name);
        let _ = picture.save(&file, SaveOptions::default()).unwrap();
        scratch.run(&["verify", name])
    };
    verify("same.exr", &|_| {}).ok();
    let at = |place: usize, value: f32| {
        let mut depth = depth.clone();
        depth[place] = value;
        Some(depth)
    };
    type Change<'c> = &'c dyn Fn(&mut Picture);
    let changes: [(Change<'_>, &str); 6] = [
        (
            &|it| it.depth = at(missed, 3.0),
            "1 value of the layer `depth` not finite",
        ),
        (
            &|it| it.depth = at(hit, f32::INFINITY),
            "1 value of the layer `depth` not finite",
        ),
        (&|it| it.depth = at(hit, 30.0), "in the layer `depth` at"),
        (
            &|it| it.depth = None,
            "the layer `depth` is not in the file",
        ),
        (
            &|it| it.opacity = None,
            "the layer `opacity` is not in the file",
        ),
        (
            &|it| {
                it.layers.push(Layer {
                    name: "more".to_owned(),
                    values: LayerValues::Scalar(vec![0.0; 24 * 8]),
                });
            },
            "the layer `more` is in the file alone",
        ),
    ];
    for (change, words) in changes {
        let run = verify("changed.exr", change);
        run.refused(&["picture-differs"]);
        assert!(run.stderr.contains(words), "{words}: {run:?}");
    }
    // As long as a digest, and its twelfth byte is within a character: told as it is.
    let name = format!("llvmpipe 12é{}", "x".repeat(51));
    let other = verify("other.exr", &|picture| {
        for (key, value) in &mut picture.metadata {
            if key == "adapter" {
                value.clone_from(&name);
            }
        }
    });
    let told = format!("adapter has changed: {name} → ");
    assert!(other.ok().stdout.contains(&told));
}
