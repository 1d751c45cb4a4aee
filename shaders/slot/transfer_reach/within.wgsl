// Whether scalars may leave the tables of transfer functions: no, they reach as far as the data do.
fn transfer_reach_is_short() -> bool {
    return false;
}
