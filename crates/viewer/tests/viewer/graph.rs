//! The graph panel: its nodes, and what any of them holds.

use egui_kittest::kittest::Queryable;
use volgraph_viewer::{Pane, Request};

use crate::desk::{Desk, assert_same, flat, graph};

#[test]
fn nodes_are_listed_and_looked_at() {
    let mut desk = Desk::open(&flat());
    let picture = desk.settle("the first picture");
    desk.tab(Pane::Graph);
    for node in ["background", "box", "image", "raycast", "proxy_box"] {
        assert!(desk.has(node), "{node}");
    }
    assert!(desk.told(|told| told.looked.is_none()));
    let ports = desk.ports();
    let at = ports.iter().position(|port| port == "image.color").unwrap();
    let looks: Vec<_> = desk.harness.query_all_by_label("Look").collect();
    assert_eq!(looks.len(), ports.len());
    looks[at].click_accesskit();
    drop(looks);
    desk.wait_until("what the port holds", |told| told.looked.is_some());
    let looked = desk.told(|told| told.looked.clone().unwrap());
    assert!(looked.trouble.is_none(), "{:?}", looked.trouble);
    assert_eq!(looked.name, "image.color");
    assert_eq!(looked.extent, [picture.width, picture.height, 1]);
    assert_eq!(looked.channels, 4);
    let [x, y] = [picture.width / 2, picture.height / 2];
    assert_eq!(looked.texel([x, y, 0]).unwrap(), [0.25, 0.5, 0.25, 1.0]);
    assert_eq!(looked.texel([0, 0, 0]).unwrap(), [0.0, 0.0, 0.125, 1.0]);
    assert_eq!(looked.range, (0.0, 0.5));
    desk.harness.run_steps(3);
    let size = format!("{} × {} × 1 rgba32float", picture.width, picture.height);
    assert!(desk.shows(&size), "{size}");
    desk.click("Close");
    desk.wait_until("that nothing is looked at", |told| {
        told.looked.is_none() && !told.is_busy
    });
    assert!(!desk.shows(&size) && !desk.has("Close"));
    assert_same(&desk.settle("the picture"), &picture);
}

/// Gradients, distances, tables, colours: whatever a node writes can be looked at.
#[test]
fn every_port_can_be_looked_at() {
    let slots = r#"{ "technique": "dvr", "light": "phong", "gradient": "stored", "traverse": "skip",
        "classify": "preintegrated_2d" }"#;
    let mut desk = Desk::open(&graph(slots, r#"{ "step": 1.0 }"#));
    let first = desk.settle("the first picture");
    desk.tab(Pane::Graph);
    let ports = desk.ports();
    let has = |kind: &str| ports.iter().any(|port| port.contains(kind));
    assert!(
        has("gradient") && has("distance") && has("integ"),
        "{ports:?}"
    );
    for port in &ports {
        desk.ask(Request::Look(Some(port.clone())));
        desk.wait_until(port, |told| {
            !told.findings.is_empty()
                || told
                    .looked
                    .as_ref()
                    .is_some_and(|looked| looked.name == *port)
        });
        let (findings, looked) = desk.told(|told| (told.findings.clone(), told.looked.clone()));
        assert!(findings.is_empty(), "{port}: {findings}");
        let looked = looked.unwrap();
        assert!(looked.trouble.is_none(), "{port}: {:?}", looked.trouble);
        let texels: usize = looked.extent.iter().map(|n| *n as usize).product();
        assert_eq!(looked.values.len(), texels * looked.channels, "{port}");
        assert!(texels > 0, "{port}");
    }
    desk.ask(Request::Look(None));
    desk.wait_until("that nothing is looked at", |told| {
        told.looked.is_none() && !told.is_busy
    });
    assert_same(&desk.settle("the picture"), &first);
}

/// A port that is not there is told, and what was looked at before stays.
#[test]
fn a_port_that_is_not_there_is_told() {
    let mut desk = Desk::open(&flat());
    desk.ask(Request::Look(Some("image.nothing".to_owned())));
    desk.wait_until("that there is none", |told| !told.findings.is_empty());
    assert!(desk.told(|told| told.shown.is_some() && told.looked.is_none()));
}
