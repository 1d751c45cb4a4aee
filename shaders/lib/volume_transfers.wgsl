// The transfer functions of several volumes: that which was selected last is read.
#import "lib/transfer_row.wgsl"

struct VolumeTransfersRow {
    @align(16) transfer: Transfer,
}

struct VolumeTransfers {
    rows: array<VolumeTransfersRow, 4>,
}

@group(2) @binding(80) var<uniform> volume_transfers: VolumeTransfers;

var<private> transfer: Transfer;
var<private> transfer_chosen: u32;

// Makes the tables those of a row.
fn transfer_select(row: u32) {
    // Rows that are no volume's are as the first.
    transfer_chosen = select(row, 0u, row > 3u);
    transfer = volume_transfers.rows[transfer_chosen].transfer;
}
