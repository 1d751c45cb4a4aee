//! The stock scenes, in which nothing but what is tested limits an order.

/// A stock scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stock {
    /// Its name.
    pub name: &'static str,
    /// Its graph.
    pub path: &'static str,
    /// What it tests.
    pub doc: &'static str,
}

/// All of them.
pub const STOCK: [Stock; 3] = [
    Stock {
        name: "volume",
        path: "embedded:/graphs/verify/volume.ron",
        doc: "volume rendering of one cell without kinks: classify, traverse, techniques that classify",
    },
    Stock {
        name: "isosurface",
        path: "embedded:/graphs/verify/isosurface.ron",
        doc: "a smooth sheet in one cell: techniques of surfaces",
    },
    Stock {
        name: "grid",
        path: "embedded:/graphs/verify/grid.ron",
        doc: "a smooth field on finer and finer grids: reconstruct",
    },
];

/// The scene that tests these choices of slots: (slot, choice).
#[must_use]
pub fn stock_for(slots: &[(String, String)]) -> &'static Stock {
    let is_surface = |choice: &str| {
        let file = choice.rsplit(['/', '\\']).next().unwrap_or(choice);
        file.contains("isosurface")
    };
    let [volume, isosurface, grid] = &STOCK;
    if slots.iter().any(|(slot, _)| slot == "reconstruct") {
        grid
    } else if slots
        .iter()
        .any(|(slot, choice)| slot == "technique" && is_surface(choice))
    {
        isosurface
    } else {
        volume
    }
}
