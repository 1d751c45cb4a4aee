//! The graph: nodes, ports, sizes, bytes, times, what ran, and what any node's output holds.

use std::collections::{BTreeMap, VecDeque};

use egui::{ComboBox, Grid, ScrollArea, Slider, TextureHandle, Ui};
use egui_plot::{Legend, Line, Plot, PlotPoints};
use volgraph_graph::{PlannedResource, ResourceKind};

use crate::looked::Looked;
use crate::worker::{Request, Told};

/// How many frames the plot of costs shows.
const FRAMES: usize = 200;

/// What the panel remembers between frames.
pub(crate) struct GraphPanel {
    axis: usize,
    index: u32,
    texture: Option<(u64, usize, u32, TextureHandle)>,
    costs: BTreeMap<String, VecDeque<[f64; 2]>>,
    last: u64,
}

impl Default for GraphPanel {
    fn default() -> Self {
        Self {
            axis: 2,
            index: 0,
            texture: None,
            costs: BTreeMap::new(),
            last: 0,
        }
    }
}

impl GraphPanel {
    /// Lets go of textures: another window makes its own.
    pub fn leave_window(&mut self) {
        self.texture = None;
    }

    pub fn show(&mut self, ui: &mut Ui, told: &Told) -> Vec<Request> {
        let Some(plan) = &told.plan else {
            ui.weak("No graph is open.");
            return Vec::new();
        };
        self.take_costs(told);
        let mut requests = Vec::new();
        ScrollArea::both().auto_shrink(false).show(ui, |ui| {
            let reports = told.frame.as_ref().map(|frame| &frame.nodes);
            Grid::new("nodes")
                .striped(true)
                .num_columns(6)
                .show(ui, |ui| {
                    for head in ["node", "kind", "from", "writes", "last frame", ""] {
                        ui.strong(head);
                    }
                    ui.end_row();
                    for node in plan.nodes() {
                        let report = reports
                            .and_then(|all| all.iter().find(|report| report.name == node.name));
                        ui.label(&node.name)
                            .on_hover_text(match &node.called_for_by {
                                Some(binding) => format!("called for by the binding {binding}"),
                                None => "named in the graph file".to_owned(),
                            });
                        ui.label(&node.kind);
                        let inputs: Vec<String> = node
                            .inputs
                            .iter()
                            .map(|(port, from)| format!("{port} from {from}"))
                            .collect();
                        ui.label(inputs.join("\n"));
                        let outputs: Vec<String> = node
                            .outputs
                            .iter()
                            .map(|output| format!("{}: {}", output.port, output.resource))
                            .collect();
                        ui.label(outputs.join("\n"));
                        let about = report.and_then(|report| report.about.as_deref());
                        let told = ui.label(match report {
                            Some(report) if report.ran => {
                                let variant = report
                                    .variant
                                    .as_deref()
                                    .map_or_else(String::new, |variant| format!(" · {variant}"));
                                match report.gpu_ms {
                                    Some(ms) => format!("{ms:.2} ms{variant}"),
                                    None => format!("ran{variant}"),
                                }
                            }
                            Some(_) => "held".to_owned(),
                            None => String::new(),
                        });
                        if let Some(about) = about {
                            told.on_hover_text(about);
                        }
                        ui.horizontal(|ui| {
                            let is_texture = |output: &&PlannedResource| {
                                matches!(output.resource, ResourceKind::Texture { .. })
                            };
                            for output in node.outputs.iter().filter(is_texture) {
                                let port = format!("{}.{}", node.name, output.port);
                                if ui
                                    .small_button("Look")
                                    .on_hover_text(format!("Show what {port} holds"))
                                    .clicked()
                                {
                                    requests.push(Request::Look(Some(port)));
                                }
                            }
                        });
                        ui.end_row();
                    }
                });
            if !plan.culled.is_empty() {
                ui.weak(format!(
                    "culled, as no output needs them: {}",
                    plan.culled.join(", ")
                ));
            }
            if let Some(frame) = &told.frame {
                let memory = &frame.memory;
                ui.weak(format!(
                    "{:.1} MiB in {} textures and {} buffers; {} pipelines; frame {:.1} ms",
                    memory.bytes as f64 / 1_048_576.0,
                    memory.textures,
                    memory.buffers,
                    frame.pipelines,
                    told.frame_ms,
                ));
            }
            self.plot(ui);
            if let Some(looked) = &told.looked {
                ui.separator();
                requests.extend(self.look(ui, looked, told.serial));
            }
        });
        requests
    }

    fn take_costs(&mut self, told: &Told) {
        if told.serial == self.last {
            return;
        }
        self.last = told.serial;
        let mut add = |name: &str, ms: f64| {
            let costs = self.costs.entry(name.to_owned()).or_default();
            costs.push_back([told.serial as f64, ms]);
            if costs.len() > FRAMES {
                costs.pop_front();
            }
        };
        add("frame", told.frame_ms);
        for node in told.frame.iter().flat_map(|frame| &frame.nodes) {
            if let Some(ms) = node.gpu_ms {
                add(&node.name, ms);
            }
        }
    }

    fn plot(&self, ui: &mut Ui) {
        Plot::new("costs")
            .height(110.0)
            .legend(Legend::default())
            .y_axis_label("ms")
            .include_y(0.0)
            .show(ui, |plot| {
                for (name, costs) in &self.costs {
                    let points: PlotPoints<'_> = costs.iter().copied().collect();
                    plot.line(Line::new(name.clone(), points));
                }
            });
    }

    fn look(&mut self, ui: &mut Ui, looked: &Looked, serial: u64) -> Vec<Request> {
        let mut requests = Vec::new();
        let [width, height, depth] = looked.extent;
        ui.horizontal(|ui| {
            ui.strong(&looked.name);
            ui.label(format!("{width} × {height} × {depth} {}", looked.format));
            ui.label(format!("{} to {}", looked.range.0, looked.range.1));
            if ui.button("Close").clicked() {
                requests.push(Request::Look(None));
            }
        });
        if let Some(trouble) = &looked.trouble {
            super::messages::findings(ui, trouble);
            return requests;
        }
        if depth > 1 {
            ui.horizontal(|ui| {
                ComboBox::from_id_salt("look axis")
                    .selected_text(["x", "y", "z"][self.axis.min(2)])
                    .show_ui(ui, |ui| {
                        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                            ui.selectable_value(&mut self.axis, axis, name);
                        }
                    });
                let last = looked.extent[self.axis.min(2)].saturating_sub(1);
                self.index = self.index.min(last);
                ui.add(Slider::new(&mut self.index, 0..=last).text("plane"));
            });
        } else {
            (self.axis, self.index) = (2, 0);
        }
        let is_same = |(of, axis, index, _): &(u64, usize, u32, TextureHandle)| {
            (*of, *axis, *index) == (serial, self.axis, self.index)
        };
        if !self.texture.as_ref().is_some_and(is_same) {
            let plane = looked.plane(self.axis, self.index);
            let codes: Vec<u8> = plane.codes.as_flattened().to_vec();
            let image = egui::ColorImage::from_rgb(plane.size, &codes);
            let texture = ui
                .ctx()
                .load_texture("look", image, egui::TextureOptions::NEAREST);
            self.texture = Some((serial, self.axis, self.index, texture));
        }
        if let Some((_, _, _, texture)) = &self.texture {
            let size = texture.size_vec2();
            let scale = (320.0 / size.max_elem().max(1.0)).max(0.25);
            let shown = ui.image((texture.id(), size * scale));
            if let Some(at) = shown.hover_pos() {
                let at = ((at - shown.rect.min) / scale).floor();
                let (column, row) = (at.x.max(0.0) as u32, at.y.max(0.0) as u32);
                let texel = match self.axis {
                    0 => [self.index, column, row],
                    1 => [column, self.index, row],
                    _ => [column, row, self.index],
                };
                if let Some(numbers) = looked.texel(texel) {
                    shown.on_hover_text(format!("{texel:?}: {numbers:?}"));
                }
            }
        }
        requests
    }
}
