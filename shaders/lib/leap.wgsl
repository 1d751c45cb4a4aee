// What the walk does next: where it goes on, and how many segments it then takes before it looks again. `leap_from` is told how
// often the part has been looked at before.

struct Leap {
    // The number of the next segment. A leap goes to an even one, so that segments keep their partners.
    index: u32,
    // How many are walked, at least one; an even number, but for the last of a part.
    segments: u32,
    // How many steps each of them takes.
    stride: u32,
}
