#![no_main]

use libfuzzer_sys::fuzz_target;
use pcs_sim::report::table::StoredTable;

fuzz_target!(|data: &[u8]| {
    let Ok(table) = StoredTable::read(&pcs_sim_fuzz::file("table", data), |_, _| None) else { return };
    let columns = table.columns().len();
    assert!(table.rows().iter().all(|row| row.len() == columns));
});
