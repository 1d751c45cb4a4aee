//! docs/technique.md: its files are taken from it, and do what it says.

use super::SMALL;
use crate::{Scratch, root};

#[test]
fn the_guide_holds() {
    let guide = std::fs::read_to_string(root().join("docs/technique.md")).unwrap();
    let scratch = Scratch::new();
    let (mut rendered, mut told) = (Vec::new(), None);
    let mut lines = guide.lines();
    let mut before = "";
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let block: String = lines
                .by_ref()
                .take_while(|line| *line != "```")
                .map(|line| format!("{line}\n"))
                .collect();
            let name = before
                .strip_prefix('`')
                .and_then(|rest| rest.strip_suffix("`:"));
            match name {
                Some(name) => {
                    scratch.write(name, &block);
                }
                None if language == "text" => told = Some(block),
                None => assert_eq!(language, "sh", "a block without a name: {block}"),
            }
            before = "";
            let is_shader_or_graph = language == "wgsl" || language == "ron";
            if is_shader_or_graph && scratch.path().join("radiograph.ron").is_file() {
                let name = format!("{}.exr", rendered.len());
                scratch.render("radiograph.ron", &name).ok();
                rendered.push(scratch.picture(&name).color);
            }
        } else if !line.is_empty() {
            before = line;
        }
    }
    assert_eq!(rendered.len(), 3, "twenty lines, the parameters, the test");
    // The defaults of the parameters are the numbers that were there before.
    assert_eq!(rendered[0], rendered[1]);
    let test = scratch.run(&["test", "tests"]).ok();
    assert!(
        test.stdout.ends_with("1 case, 4 expectations\n"),
        "{}",
        test.stdout
    );
    let bright = scratch.run(
        &[
            &[
                "render",
                "radiograph.ron",
                "-o",
                "d.exr",
                "--set",
                "image.density=8",
            ],
            &SMALL[..],
        ]
        .concat(),
    );
    bright.ok();
    assert_ne!(scratch.picture("d.exr").color, rendered[1]);
    let listed = scratch
        .run(&["nodes", "raycast", "--shaders", "."])
        .ok()
        .stdout;
    assert!(
        listed.contains("param density = 2.0, 0.0 to 1000.0"),
        "{listed}"
    );
    // The error that it shows.
    scratch.run(&["check", "."]).ok();
    scratch.edit(
        "slot/technique/radiograph.wgsl",
        "params.density ",
        "params.densty ",
    );
    let run = scratch.run(&["check", "."]);
    assert!(
        run.stderr.contains(told.unwrap().trim_end()),
        "{}",
        run.stderr
    );
}
