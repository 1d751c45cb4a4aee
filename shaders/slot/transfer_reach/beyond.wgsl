// Whether scalars may leave the tables of transfer functions: yes. Segments that do are cut there, which costs more reads.
fn transfer_reach_is_short() -> bool {
    return true;
}
