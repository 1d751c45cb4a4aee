//! The planted mistakes.

pub struct Planted {
    pub what: &'static str,
    pub file: &'static str,
    /// This text, which stands in the file, is replaced; an empty one stands at the end.
    pub find: &'static str,
    pub with: &'static str,
    pub code: &'static str,
    /// Where the finding must be.
    pub needle: &'static str,
    /// What it must suggest.
    pub help: Option<&'static str>,
    /// The codes of what else is true of it.
    pub more: &'static [&'static str],
    /// Planted in the same edit, and found in the same run.
    pub also: Option<&'static Planted>,
}

const PLAIN: Planted = Planted {
    what: "",
    file: "",
    find: "",
    with: "",
    code: "",
    needle: "",
    help: None,
    more: &[],
    also: None,
};

pub const GRAPH: &str = "graphs/quickstart.ron";

// An author's own files: the technique imports the first, which imports the second, which imports the third.
pub const A: &str = "shaders/mine/a.wgsl";
pub const B: &str = "shaders/mine/b.wgsl";
pub const C: &str = "shaders/mine/c.wgsl";

pub const MINE: [(&str, &str); 3] = [
    (
        A,
        "// A.\n#import \"mine/b.wgsl\"\nfn a_depth(ray: Ray) -> f32 {\n    return b_depth(ray) * 2.0;\n}\n",
    ),
    (
        B,
        "// B.\n\n#import \"mine/c.wgsl\"\nfn b_depth(ray: Ray) -> f32 {\n    return c_depth(CState(1.0), ray);\n}\n",
    ),
    (
        C,
        "// C.\n#import \"lib/ray.wgsl\"\nstruct CState {\n    depth: f32,\n}\n\n\
         fn c_depth(state: CState, ray: Ray) -> f32 {\n    let from_entry = state.depth + ray.near;\n    \
         return from_entry;\n}\n",
    ),
];

pub const PLANTED: [Planted; 30] = [
    Planted {
        what: "syntax",
        file: "shaders/slot/technique/dvr.wgsl",
        find: "let color = light_segment(",
        with: "let color = ) light_segment(",
        code: "wgsl-syntax",
        needle: ") light_segment(",
        ..PLAIN
    },
    Planted {
        what: "type",
        file: "shaders/slot/classify/post.wgsl",
        find: "",
        with: "\nfn classify_wrong() {\n    var count: i32 = vec3f(1.0);\n}\n",
        code: "wgsl-type",
        needle: "count: i32",
        ..PLAIN
    },
    Planted {
        what: "unknown name",
        file: "shaders/slot/light/phong.wgsl",
        find: "facing, -ray.direction, false)",
        with: "facing, -rya.direction, false)",
        code: "wgsl-type",
        needle: "rya.direction",
        help: Some("did you mean `ray`?"),
        ..PLAIN
    },
    Planted {
        what: "name clash",
        file: "shaders/lib/volume.wgsl",
        find: "",
        with: "\nfn ray_through() {}\n",
        code: "name-clash",
        needle: "ray_through() {}",
        ..PLAIN
    },
    Planted {
        what: "binding clash",
        file: "shaders/lib/gradient_texture.wgsl",
        find: "@group(1) @binding(4) var gradient_volume",
        with: "@group(1) @binding(1) var gradient_volume",
        code: "binding-clash",
        needle: "gradient_volume: texture_3d",
        ..PLAIN
    },
    Planted {
        what: "missing import",
        file: "shaders/slot/light/phong.wgsl",
        find: "#import \"lib/phong.wgsl\"",
        with: "#import \"lib/phongs.wgsl\"",
        code: "missing-import",
        needle: "#import \"lib/phongs.wgsl\"",
        ..PLAIN
    },
    Planted {
        what: "cyclic import",
        file: "shaders/lib/frame.wgsl",
        find: "struct Lens {",
        with: "#import \"lib/ray.wgsl\"\nstruct Lens {",
        code: "import-cycle",
        needle: "#import \"lib/ray.wgsl\"",
        more: &["import-cycle"],
        ..PLAIN
    },
    Planted {
        what: "unknown slot",
        file: "shaders/slot/technique/dvr.wgsl",
        find: "#import slot \"light\"",
        with: "#import slot \"lihgt\"",
        code: "slot-unset",
        needle: "#import slot \"lihgt\"",
        help: Some("did you mean the slot `light`?"),
        ..PLAIN
    },
    Planted {
        what: "unknown choice",
        file: GRAPH,
        find: "\"light\": \"phong\"",
        with: "\"light\": \"phnog\"",
        code: "unknown-choice",
        needle: "\"phnog\"",
        ..PLAIN
    },
    Planted {
        what: "missing slot function",
        file: "shaders/slot/reconstruct/nearest.wgsl",
        find: "fn reconstruct_scalar(",
        with: "fn reconstruct_scaler(",
        code: "slot-function",
        needle: "// The scalar at a point",
        ..PLAIN
    },
    Planted {
        what: "bad parameter doc",
        file: "shaders/lib/step.wgsl",
        find: "@default 1.0",
        with: "@default one",
        code: "params-doc",
        needle: "one @range",
        ..PLAIN
    },
    Planted {
        what: "unknown uniform member",
        file: "shaders/lib/proxy.wgsl",
        find: "struct Tile {",
        with: "struct Tile {\n    temperature: f32,",
        code: "uniform",
        needle: "tile: Tile;",
        ..PLAIN
    },
    Planted {
        what: "validation",
        file: "shaders/slot/technique/dvr.wgsl",
        find: "",
        with: "\nfn technique_wrong(x: f32) -> bool {\n    return x * 2.0;\n}\n",
        code: "wgsl-validation",
        needle: "x * 2.0;",
        ..PLAIN
    },
    Planted {
        what: "type, three files deep",
        file: C,
        find: "let from_entry =",
        with: "let from_entry: i32 =",
        code: "wgsl-type",
        needle: "from_entry: i32",
        ..PLAIN
    },
    Planted {
        what: "syntax, three files deep",
        file: C,
        find: "+ ray.near;",
        with: "+ ;",
        code: "wgsl-syntax",
        needle: ";\n    return",
        ..PLAIN
    },
    Planted {
        what: "unknown name, three files deep",
        file: C,
        find: "return from_entry;",
        with: "return from_enrty;",
        code: "wgsl-type",
        needle: "from_enrty;",
        help: Some("did you mean `from_entry`?"),
        ..PLAIN
    },
    Planted {
        what: "validation, three files deep",
        file: C,
        find: "return from_entry;",
        with: "return from_entry == 1.0;",
        code: "wgsl-validation",
        needle: "from_entry == 1.0",
        ..PLAIN
    },
    Planted {
        what: "missing import, three files deep",
        file: C,
        find: "\"lib/ray.wgsl\"",
        with: "\"lib/nowhere.wgsl\"",
        code: "missing-import",
        needle: "#import \"lib/nowhere.wgsl\"",
        ..PLAIN
    },
    Planted {
        what: "misspelt import, three files deep",
        file: C,
        find: "\"lib/ray.wgsl\"",
        with: "\"lib/rya.wgsl\"",
        code: "missing-import",
        needle: "#import \"lib/rya.wgsl\"",
        help: Some("did you mean `lib/ray.wgsl`?"),
        ..PLAIN
    },
    Planted {
        what: "binding clash, three files deep",
        file: C,
        find: "",
        with: "\n@group(0) @binding(0) var<uniform> c_lens: vec4f;\n",
        code: "binding-clash",
        needle: "c_lens: vec4f",
        ..PLAIN
    },
    Planted {
        what: "unknown member",
        file: C,
        find: "state.depth",
        with: "state.dept",
        code: "wgsl-type",
        needle: "dept +",
        help: Some("did you mean `depth`?"),
        ..PLAIN
    },
    Planted {
        what: "two errors of one edit",
        file: C,
        find: "return from_entry;",
        with: "return 1u;",
        code: "wgsl-validation",
        needle: "1u;",
        also: Some(&Planted {
            what: "in another function of another file",
            file: A,
            find: "b_depth(ray)",
            with: "b_depth(rya)",
            code: "wgsl-type",
            needle: "rya)",
            help: Some("did you mean `ray`?"),
            ..PLAIN
        }),
        ..PLAIN
    },
    Planted {
        what: "wrong argument count",
        file: B,
        find: "c_depth(CState(1.0), ray)",
        with: "c_depth(CState(1.0))",
        code: "wgsl-validation",
        needle: "c_depth(CState(1.0))",
        ..PLAIN
    },
    Planted {
        what: "wrong return type",
        file: B,
        find: "return c_depth(CState(1.0), ray)",
        with: "return vec2f(c_depth(CState(1.0), ray))",
        code: "wgsl-validation",
        needle: "vec2f(",
        ..PLAIN
    },
    Planted {
        what: "unknown port",
        file: GRAPH,
        find: "\"rays\": \"box\"",
        with: "\"ray\": \"box\"",
        code: "unknown-port",
        needle: "ray\": \"box\"",
        help: Some("did you mean `rays`?"),
        more: &["missing-input"],
        ..PLAIN
    },
    Planted {
        what: "unknown parameter",
        file: GRAPH,
        find: "\"step\": 1.0",
        with: "\"stpe\": 1.0",
        code: "unknown-param",
        needle: "stpe",
        help: Some("did you mean `step`?"),
        ..PLAIN
    },
    Planted {
        what: "unknown node in an edge",
        file: GRAPH,
        find: "\"rays\": \"box\"",
        with: "\"rays\": \"bxo\"",
        code: "unknown-node",
        needle: "\"bxo\"",
        help: Some("did you mean `box`?"),
        ..PLAIN
    },
    Planted {
        what: "parameter out of its range",
        file: GRAPH,
        find: "\"step\": 1.0",
        with: "\"step\": -1.0",
        code: "bad-param",
        needle: "-1.0",
        ..PLAIN
    },
    Planted {
        what: "technique function with a wrong signature",
        file: "shaders/slot/technique/dvr.wgsl",
        find: "fn technique_finish(state: TechniqueState, ray: Ray)",
        with: "fn technique_finish(state: TechniqueState)",
        code: "slot-function",
        needle: "technique_finish(state",
        ..PLAIN
    },
    Planted {
        what: "missing entry point",
        file: "shaders/node/raycast.wgsl",
        find: "fn raycast_vertex(",
        with: "fn raycast_vertx(",
        code: "missing-entry",
        needle: "raycast_vertx(",
        help: Some("is `raycast_vertx` meant to be it?"),
        ..PLAIN
    },
];
