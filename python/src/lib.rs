//! The simulator as a Python module: parameters in, runs out. All that is simulated, checked and written is the crate
//! `pcs-sim`'s; here its values become Python's.

mod arrays;
mod calls;
mod cells;
mod doing;
mod graphs;
mod machine;
mod made;
mod model;
mod outputs;
mod request;
mod run;
mod sizes;
mod stepping;
mod sweep;
mod table;
mod trouble;
mod view;
mod why;
mod work;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::arrays::Scene;
    #[pymodule_export]
    use super::calls::{farm, image, ipsc2, replay, run};
    #[pymodule_export]
    use super::cells::{CellProgram, assemble};
    #[pymodule_export]
    use super::machine::{Machine, Program};
    #[pymodule_export]
    use super::model::{Model, model};
    #[pymodule_export]
    use super::request::{parameters, scenes};
    #[pymodule_export]
    use super::run::Run;
    #[pymodule_export]
    use super::sizes::{Sizes, size_fifos};
    #[pymodule_export]
    use super::stepping::Stepping;
    #[pymodule_export]
    use super::sweep::sweep;
    #[pymodule_export]
    use super::table::Table;
    #[pymodule_export]
    use super::trouble::{CellFault, Deadlock, InputError};
    #[pymodule_export]
    use super::view::Picture;
    #[pymodule_export]
    use super::why::{Why, why};

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
