//! The elastic contact behind an equivalent profile: solved once per node and once per step.

use crate::tabulated::{Node, Tabulated};
use contact_model::{
    ContactState, Error, Nondimensionalisation, NormalLoad, Normalisation, Outputs, PreparedContact, Result,
    Stop, Work,
};
use std::sync::Arc;

pub(super) const NAME: &str = "equivalent";

/// The elastic contact of M and the profile that its states give; lengths in L, forces in E* L^2.
pub(super) struct Normal {
    contact: Box<dyn PreparedContact>,
    /// The same with fields and patches, for the steps themselves.
    full: Option<Box<dyn PreparedContact>>,
    pub normalisation: Normalisation,
    outputs: Outputs,
    pub nondimensional: Nondimensionalisation,
    /// Rms height, 0 without one.
    height: f64,
    per_decade: f64,
    /// Nodes below the first load.
    span: i32,
    /// Place of the first node on the lattice.
    lowest: i32,
    /// The nodes on the lattice, without a gap.
    nodes: Vec<Node>,
    /// The deepest load, where that is beyond the last node.
    end: Option<Node>,
    pub table: Arc<Tabulated>,
    spent: Spent,
}

/// What M did since the last report.
#[derive(Debug, Clone, Copy, Default)]
struct Spent {
    iterations: usize,
    applications: usize,
    work: Work,
}

impl Spent {
    fn add(&mut self, state: &ContactState) {
        self.iterations += state.report.iterations;
        self.applications += state.report.applications;
        self.work += state.report.work;
    }
}

/// A load this close to the next node of the lattice, in spacings, does not have that node solved.
const NEAR: f64 = 0.25;

impl Normal {
    /// A contact of M that gives the stiffness, one that gives everything where that is more, and how dense
    /// and how far the table goes.
    pub fn new(
        contact: Box<dyn PreparedContact>,
        full: Option<Box<dyn PreparedContact>>,
        outputs: Outputs,
        per_decade: f64,
        span: i32,
    ) -> Result<Self> {
        let normalisation = contact.normalisation();
        let nondimensional = Nondimensionalisation::new(
            normalisation.contact_modulus,
            normalisation.length,
            normalisation.length,
        )?;
        Ok(Self {
            contact,
            full,
            normalisation,
            outputs,
            nondimensional,
            height: normalisation.height.map_or(0.0, |height| nondimensional.approach_in(height)),
            per_decade,
            span,
            lowest: 0,
            nodes: Vec::new(),
            end: None,
            table: Arc::new(Tabulated::new(&[])?),
            spent: Spent::default(),
        })
    }

    /// M's state under a load, and the same as a node.
    pub fn solve(&mut self, load: NormalLoad, stop: Stop<'_>) -> Result<(ContactState, Node)> {
        let contact = self.full.as_mut().unwrap_or(&mut self.contact);
        let state = contact.solve_until(load.into(), stop)?;
        self.spent.add(&state);
        let node = self.node(&state)?;
        Ok((state, node))
    }

    fn node(&self, state: &ContactState) -> Result<Node> {
        /// A certificate bounds the mean error; single numbers may have an error larger by this factor.
        const GENEROUS: f64 = 10.0;
        /// Of closed forms.
        const ROUNDING: f64 = 1e-10;
        let (Some(approach), Some(stiffness)) = (state.approach, state.stiffness) else {
            return Err(Error::unsupported(NAME, "a model without approach and stiffness"));
        };
        let nondimensional = self.nondimensional;
        let unit = nondimensional.stiffness(1.0)?;
        let (approach, force, radius) = (
            nondimensional.approach_in(approach),
            nondimensional.force_in(state.force),
            0.5 * (stiffness / unit),
        );
        if force > 0.0 && !(approach > 0.0 && radius > 0.0 && radius.is_finite() && approach.is_finite()) {
            return Err(Error::not_representable("approach over side", approach));
        }
        // The certificate counts gaps in rms heights.
        let lever = if force > 0.0 { 1.0 + 2.0 * radius * self.height / force } else { 1.0 };
        let worst = state.report.certificate.worst();
        Ok(Node { approach, force, radius, slack: GENEROUS * worst * lever + ROUNDING })
    }

    /// Makes the table reach a state just solved; nodes below the lowest are added before any contact only.
    pub fn reach(&mut self, state: Node, fresh: bool, stop: Stop<'_>) -> Result<()> {
        if state.force <= 0.0 {
            return Ok(());
        }
        let unit = if self.height > 0.0 { self.height } else { 1.0 };
        let place = (state.approach / unit).log10() * self.per_decade;
        let top = (place - NEAR).floor() as i32;
        let deepest = self.end.or(self.nodes.last().copied()).map_or(0.0, |node| node.approach);
        let bottom = top - self.span;
        if self.nodes.is_empty() {
            self.lowest = top + 1;
        }
        if state.approach <= deepest && (!fresh || bottom >= self.lowest) {
            return Ok(());
        }
        if fresh && bottom < self.lowest {
            let below = self.solved(bottom, self.lowest - 1, unit, stop)?;
            self.nodes.splice(0..0, below);
            self.lowest = bottom;
        }
        let next = self.lowest + i32::try_from(self.nodes.len()).unwrap_or(i32::MAX);
        let above = self.solved(next, top, unit, stop)?;
        self.nodes.extend(above);
        if state.approach > deepest {
            self.end = Some(state);
        }
        // A lattice that has come past the end does not need it any more.
        let last = self.nodes.last().map_or(0.0, |node| node.approach);
        self.end = self.end.filter(|end| end.approach > last);
        let all: Vec<Node> = self.nodes.iter().copied().chain(self.end).collect();
        self.table = Arc::new(Tabulated::new(&all)?);
        Ok(())
    }

    /// The nodes at these places of the lattice, in ascending order.
    fn solved(&mut self, from: i32, to: i32, unit: f64, stop: Stop<'_>) -> Result<Vec<Node>> {
        let mut nodes = Vec::new();
        for place in from..=to {
            let approach = unit * 10.0_f64.powf(f64::from(place) / self.per_decade);
            let load = NormalLoad::Approach(self.nondimensional.approach(approach)?);
            let state = self.contact.solve_until(load.into(), stop)?;
            self.spent.add(&state);
            let node = self.node(&state)?;
            if node.force <= 0.0 {
                return Err(Error::domain("force at a node", node.force, "a number > 0 (fewer decades)"));
            }
            nodes.push(node);
        }
        Ok(nodes)
    }

    /// M's state as part of a history: its own outputs, what it cost with all nodes, and what it rests on.
    pub fn reported(&mut self, mut state: ContactState, approach: f64) -> ContactState {
        let Spent { iterations, applications, work } = std::mem::take(&mut self.spent);
        let report = &mut state.report;
        (report.iterations, report.applications, report.work) = (iterations, applications, work);
        report.strategy = format!(
            "{}; g(x) through {} states, uncertainty {:.1e}",
            report.strategy,
            self.table.nodes(),
            self.table.uncertainty(approach)
        );
        state.stiffness = state.stiffness.filter(|_| self.outputs.stiffness);
        state
    }
}
