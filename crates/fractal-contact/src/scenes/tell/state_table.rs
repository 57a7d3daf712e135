//! The table of the states of a run. Everything that is told of a run reads it: the tables, the console, the
//! report, the pictures and Python.

use crate::scenes::read::{Result, SceneFile};
use crate::scenes::run::{SolvedUnit, StateRecord};
use crate::scenes::tell::{Mean, columns, ensemble};
use contact_model::Table;

/// The states of a scene.
pub(crate) struct StateTable<'a> {
    pub scene: &'a SceneFile,
    /// Each model on each surface, in the order of the tables.
    pub units: Vec<SolvedUnit<'a>>,
    /// Means over the surfaces; none of one surface.
    pub means: Vec<Mean>,
    /// Title of its tables.
    pub title: String,
}

impl<'a> StateTable<'a> {
    pub fn new(scene: &'a SceneFile, units: Vec<SolvedUnit<'a>>, title: String) -> Self {
        let means = if scene.sampling.surfaces > 1 { ensemble::means(scene, &units) } else { Vec::new() };
        Self { scene, units, means, title }
    }

    /// All states in their order, each with its model and surface.
    pub fn records(&self) -> impl Iterator<Item = (&SolvedUnit<'a>, &'a StateRecord)> {
        self.units.iter().flat_map(|unit| unit.states.iter().map(move |record| (unit, record)))
    }

    /// The states of a model on all surfaces.
    pub fn of_model(&self, model: &str) -> impl Iterator<Item = &'a StateRecord> {
        self.units.iter().filter(move |unit| unit.model == model).flat_map(|unit| unit.states)
    }

    /// The quantities of all states, `results.csv`.
    pub fn results(&self) -> Result<Table> {
        let mut table = Table::new(self.title.clone(), columns::columns(self.scene));
        for (unit, record) in self.records() {
            table.push(columns::row(self.scene, unit, record)).map_err(runs::Error::model("a row"))?;
        }
        Ok(table)
    }

    /// The connected contacts of all states, `patches.csv`.
    pub fn patches(&self) -> Result<Table> {
        let area = ("area", self.scene.system.unit("m^2"), "of one connected contact, the largest first");
        let title = format!("{}: connected contact areas", self.title);
        let rows = self.records().flat_map(|(unit, record)| {
            let patches = record.solved().and_then(|solved| solved.state.patches.as_ref());
            let areas = patches.map_or(&[][..], contact_model::Patches::areas);
            areas
                .iter()
                .map(|&area| [unit.model.into(), unit.surface.into(), record.index.into(), area.into()])
        });
        let columns = [columns::MODEL, columns::SURFACE, columns::LOAD, area];
        Ok(columns::table(title, columns, rows, "a patch")?)
    }

    /// The means over surfaces, `ensemble.csv`; `None` of one surface.
    pub fn ensemble(&self) -> Result<Option<Table>> {
        if self.means.is_empty() {
            return Ok(None);
        }
        let title = format!("{}: means over surfaces", self.title);
        let table = ensemble::table(self.scene, title, &self.means);
        Ok(Some(table.map_err(runs::Error::model("means over surfaces"))?))
    }
}
