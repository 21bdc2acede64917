#![no_main]

use libfuzzer_sys::fuzz_target;
use pcs_sim::report::table::StoredTable;

// Damaged Parquet, which a library reads, has a test of its own (tests/it/plots_of_tables.rs).
fuzz_target!(|data: &[u8]| {
    if data.starts_with(b"PAR1") {
        return;
    }
    let Ok(table) = StoredTable::read(&pcs_sim_fuzz::file("table", data), |_, _| None) else { return };
    let columns = table.columns().len();
    assert!(table.rows().iter().all(|row| row.len() == columns));
});
