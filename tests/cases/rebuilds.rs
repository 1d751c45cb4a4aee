//! An edit builds the pipelines of the shaders that it changes, and no other.

use std::collections::{BTreeMap, BTreeSet};

use volgraph::{Change, Outcome, ParamOverride, Session};
use volgraph_graph::CameraDesc;
use volgraph_tests::{Stage, adapters, graph, root};

const TECHNIQUE: &str = "slot/technique/mine.wgsl";
const TRANSFER: &str =
    "(points: [(at: 0, color: (0, 0, 1), opacity: 0), (at: 1, color: (1, 0, 0), opacity: 0.5)])";

fn own(file: &str) -> String {
    std::fs::read_to_string(root().join("shaders").join(file)).unwrap()
}

fn stage() -> (Stage, String) {
    let text = graph(
        r#"path: "v_8x8x8_float32.raw""#,
        "orbit(azimuth: 10, elevation: 10)",
        r#"{ "pattern": "checker" }"#,
        r#"{ "technique": "mine", "light": "phong" }"#,
        r#"{ "stage": "fragment", "step": 1.0 }"#,
    );
    let stage = Stage::new()
        .with_floats("v", [8, 8, 8], |x, y, z| (x * y + z) as f32)
        .with("transfer.ron", TRANSFER)
        .with(TECHNIQUE, own("slot/technique/dvr.wgsl"))
        .with("lib/frame.wgsl", own("lib/frame.wgsl"))
        .with("node/background.wgsl", own("node/background.wgsl"))
        .with("graph.ron", &text);
    (stage, text)
}

/// The nodes of which pipelines were built, each with their number.
fn built(session: &mut Session, change: &Change) -> BTreeMap<String, usize> {
    let drawn = match session.apply(change) {
        Ok(Outcome::Drawn(drawn)) => drawn,
        Ok(Outcome::Unchanged) => panic!("{change:?} makes a difference"),
        Err(refused) => panic!("{}", refused.findings),
    };
    let mut built = BTreeMap::new();
    for name in &drawn.report.pipelines_built {
        let node = name.split(' ').next().unwrap().to_owned();
        *built.entry(node).or_insert(0) += 1;
    }
    built
}

#[test]
fn an_edit_builds_what_it_changes() {
    for backend in adapters() {
        let (stage, text) = stage();
        let mut session = stage.open("graph.ron", &[], &backend, [32, 32]).unwrap();
        session.render().unwrap();
        let files = Change::Files(BTreeSet::new());
        let none = BTreeMap::new();
        // A parameter, a camera and a slot's text apart: the graph alone.
        stage.write("graph.ron", text.replace("\"step\": 1.0", "\"step\": 0.5"));
        assert_eq!(built(&mut session, &files), none, "{backend}: a parameter");
        stage.write("graph.ron", text.replace("azimuth: 10", "azimuth: 20"));
        assert_eq!(built(&mut session, &files), none, "{backend}: the camera");
        stage.write("graph.ron", &text);
        assert_eq!(built(&mut session, &files), none, "{backend}: back");
        let transfer = stage.path().join("transfer.ron");
        stage.write("transfer.ron", TRANSFER.replace("0.5", "0.75"));
        let changed = Change::Files([transfer].into());
        assert_eq!(
            built(&mut session, &changed),
            none,
            "{backend}: the transfer function"
        );
        let set = ParamOverride::parse("image.step=0.25").unwrap();
        assert_eq!(
            built(&mut session, &Change::Set(vec![set])),
            none,
            "{backend}: a value"
        );
        let camera = Change::Camera(CameraDesc::default());
        assert_eq!(built(&mut session, &camera), none, "{backend}: a camera");
        // The technique: its node's two passes, and nothing of the background or the gradients.
        let technique = own("slot/technique/dvr.wgsl");
        stage.write(
            TECHNIQUE,
            technique.replace("= light_segment", "= 0.5 * light_segment"),
        );
        let image = BTreeMap::from([("image".to_owned(), 2)]);
        assert_eq!(
            built(&mut session, &files),
            image,
            "{backend}: the technique"
        );
        // The background's own shader.
        let background = own("node/background.wgsl");
        stage.write(
            "node/background.wgsl",
            format!("{background}\nconst background_more = 1.0;\n"),
        );
        let only = BTreeMap::from([("background".to_owned(), 1)]);
        assert_eq!(
            built(&mut session, &files),
            only,
            "{backend}: the background"
        );
        // A library deep below both.
        let library = own("lib/frame.wgsl");
        stage.write(
            "lib/frame.wgsl",
            format!("{library}\nconst frame_more = 1.0;\n"),
        );
        let built = built(&mut session, &files);
        let nodes = &session.plan().graph.nodes;
        let imports = |node: &&volgraph_graph::Node| {
            let program = node.program.as_ref();
            let mut files = program
                .iter()
                .flat_map(|program| &program.module.linked.files);
            files.any(|file| file.path.ends_with("lib/frame.wgsl"))
        };
        let importing: Vec<&String> = nodes.iter().filter(imports).map(|it| &it.name).collect();
        assert!(importing.len() >= 2, "{importing:?}");
        for node in &importing {
            assert!(built.contains_key(*node), "{backend}: {node} in {built:?}");
        }
        assert_eq!(built.len(), importing.len(), "{backend}: a library of them");
    }
}

/// A choice is a constant of its node's pipelines: another one is another picture, and builds that node's anew. A number
/// is in the uniform. Going back is going back.
#[test]
fn a_choice_builds_its_own_node_and_changes_the_picture() {
    for backend in adapters() {
        let text = graph(
            r#"path: "v_8x8x8_float32.raw""#,
            "orbit(azimuth: 10, elevation: 10)",
            r#"{ "pattern": "checker" }"#,
            r#"{ "technique": "isosurface" }"#,
            r#"{ "stage": "fragment", "step": 2.5, "isovalue": 0.4 }"#,
        );
        let stage = Stage::new()
            .with_floats("v", [8, 8, 8], |x, y, z| (x * y + z) as f32)
            .with("transfer.ron", TRANSFER)
            .with("graph.ron", &text);
        let mut session = stage.open("graph.ron", &[], &backend, [32, 32]).unwrap();
        let first = session.render().unwrap().0.color;
        let mut set = |set: &str| {
            let change = Change::Set(vec![ParamOverride::parse(set).unwrap()]);
            let built = built(&mut session, &change);
            (built, session.render().unwrap().0.color)
        };
        let image = BTreeMap::from([("image".to_owned(), 2)]);
        let (below, solid_below) = set("image.solid=below");
        assert_eq!(below, image, "{backend}: a choice");
        assert_ne!(solid_below, first, "{backend}: a choice");
        let (above, solid_above) = set("image.solid=above");
        assert_eq!(above, image, "{backend}: the choice before");
        assert_eq!(solid_above, first, "{backend}: the choice before");
        let (number, nearer) = set("image.isovalue=0.2");
        assert_eq!(number, BTreeMap::new(), "{backend}: a number");
        assert_ne!(nearer, first, "{backend}: a number");
    }
}
