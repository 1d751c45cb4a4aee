//! The panels in their layout.

use std::sync::Arc;

use egui::Ui;
use egui_tiles::{Behavior, SimplificationOptions, TileId, Tiles, Tree, UiResponse};

use crate::blit::Shot;
use crate::histogram::{Histograms, first_range, first_volume};
use crate::panels::graph::GraphPanel;
use crate::panels::slices::SlicesPanel;
use crate::panels::transfer::TransferSight;
use crate::panels::{messages, parameters, ray, transfer};
use crate::settings::{Pane, Settings};
use crate::transfer::TransferEdit;
use crate::view::View;
use crate::worker::{Request, Told};

/// What panels remember.
#[derive(Default)]
pub(super) struct Panels {
    pub view: View,
    pub graph: GraphPanel,
    pub slices: SlicesPanel,
    pub transfer: Option<TransferEdit>,
    pub histograms: Histograms,
    /// The study that the slices followed last.
    pub followed: usize,
}

/// The panels, as the layout shows them.
pub(super) struct Panes<'a> {
    pub told: &'a Told,
    pub shot: Option<&'a Shot>,
    pub settings: &'a mut Settings,
    pub panels: &'a mut Panels,
    pub requests: &'a mut Vec<Request>,
}

impl Behavior<Pane> for Panes<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        let frame = match pane {
            Pane::View => egui::Frame::NONE,
            _ => egui::Frame::NONE.inner_margin(6.0),
        };
        frame.show(ui, |ui| self.pane(ui, *pane));
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        let count = self.told.findings.len();
        match pane {
            Pane::Messages if count > 0 => format!("Messages ({count})").into(),
            _ => pane.title().into(),
        }
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions {
            all_panes_must_have_tabs: true,
            ..Default::default()
        }
    }
}

impl Panes<'_> {
    fn pane(&mut self, ui: &mut Ui, pane: Pane) {
        let (told, panels) = (self.told, &mut *self.panels);
        let asked = match pane {
            Pane::View => {
                let crosshair = told
                    .scene
                    .as_ref()
                    .and_then(first_volume)
                    .and_then(|(_, digest, volume)| panels.slices.crosshair(digest, &volume));
                let view = &mut panels.view;
                let mut asked = view.show(ui, told, self.shot, self.settings, crosshair);
                asked.extend(panels.window(told));
                asked
            }
            Pane::Parameters => parameters::show(ui, told),
            Pane::Messages => {
                messages::show(ui, told);
                Vec::new()
            }
            Pane::Graph => panels.graph.show(ui, told),
            Pane::Slices => {
                match told.scene.as_ref().and_then(first_volume) {
                    Some((_, digest, volume)) => panels.slices.show(ui, digest, &volume),
                    None => {
                        ui.weak("The graph has no volume.");
                    }
                }
                Vec::new()
            }
            Pane::Transfer => panels.transfer(ui, told, self.settings),
            Pane::Ray => {
                ray::show(ui, told);
                Vec::new()
            }
        };
        self.requests.extend(asked);
    }
}

impl Panels {
    /// The crosshair of the slices goes to where the studied ray met most.
    pub fn follow_ray(&mut self, told: &Told) {
        let Some(Ok(study)) = &told.ray else {
            return;
        };
        let key = Arc::as_ptr(study) as usize;
        let place = study.hit.as_ref().or(study.strongest.as_ref());
        if let (true, Some(probe), Some(scene)) = (self.followed != key, place, &told.scene)
            && let Some((_, digest, volume)) = first_volume(scene)
        {
            self.slices.go_to(digest, &volume, probe.world.into());
        }
        self.followed = key;
    }

    /// Window and level: a drag over the picture shifts the transfer function (across) and stretches it (down).
    fn window(&mut self, told: &Told) -> Vec<Request> {
        let drag = self.view.window.take();
        let Some(edit) = self.edit(told) else {
            return Vec::new();
        };
        let Some([right, down]) = drag else {
            if !edit.is_panel_dragging {
                edit.end_drag();
            }
            return Vec::new();
        };
        edit.begin_drag();
        let (low, high) = edit.transfer.range();
        edit.window(right * (high - low), 1.0 + 2.0 * down)
    }

    /// The transfer function of the scene, under edit.
    fn edit(&mut self, told: &Told) -> Option<&mut TransferEdit> {
        let scene = told.scene.as_ref()?;
        match &mut self.transfer {
            Some(edit) => edit.follow(scene),
            none => *none = TransferEdit::of(scene),
        }
        self.transfer.as_mut()
    }

    fn transfer(&mut self, ui: &mut Ui, told: &Told, settings: &mut Settings) -> Vec<Request> {
        let Some(scene) = &told.scene else {
            ui.weak("No graph is open.");
            return Vec::new();
        };
        self.edit(told);
        let (Some(edit), Some((_, digest, volume))) = (&mut self.transfer, first_volume(scene))
        else {
            ui.weak("The graph has no volume with a transfer function.");
            return Vec::new();
        };
        let counted = self.histograms.of(digest, &volume, ui.ctx());
        let sight = TransferSight {
            volume: &volume,
            range: first_range(scene),
            counted: counted.as_ref().and_then(|counted| counted.get()),
        };
        transfer::show(ui, edit, &sight, &mut settings.is_log)
    }
}

/// The view, what changes it on its right, what tells of it below.
pub(super) fn default_layout() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let mut pane = |pane: Pane| tiles.insert_pane(pane);
    let (view, parameters, messages) = (
        pane(Pane::View),
        pane(Pane::Parameters),
        pane(Pane::Messages),
    );
    let (transfer, graph) = (pane(Pane::Transfer), pane(Pane::Graph));
    let (slices, ray) = (pane(Pane::Slices), pane(Pane::Ray));
    let below = tiles.insert_tab_tile(vec![transfer, messages, graph, slices, ray]);
    let left = tiles.insert_vertical_tile(vec![view, below]);
    let right = tiles.insert_tab_tile(vec![parameters]);
    let root = tiles.insert_horizontal_tile(vec![left, right]);
    for (container, shares) in [
        (left, [(view, 1.7), (below, 1.0)]),
        (root, [(left, 3.0), (right, 1.0)]),
    ] {
        if let Some(egui_tiles::Tile::Container(egui_tiles::Container::Linear(linear))) =
            tiles.get_mut(container)
        {
            for (tile, share) in shares {
                linear.shares.set_share(tile, share);
            }
        }
    }
    Tree::new(egui::Id::unique("panels"), root, tiles)
}
