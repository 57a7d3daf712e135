//! The states of a run as tables for a terminal and for the report: each column in the multiple of its unit
//! that suits its numbers. Files have plain SI.

use crate::scenes::read::{LoadList, LoadRequest, SceneFile, amount, multiple, number, short};
use crate::scenes::run::StateRecord;
use crate::scenes::tell::stated_error::{
    OF_GRID, OF_GRID_UNCONFIRMED, OF_SOLVER, PLUS_MINUS, relative_error, with_error,
};
use crate::scenes::tell::{Mean, StateTable, columns, cycles, ensemble, thresholds};
use contact_model::Value;
use contact_model::quantities::{QuantityUnit, Role, StateQuantity};
use contact_model::units::rounded;

/// More states of a model than these are left to the files.
const MOST: usize = 24;
/// Characters of a line on a terminal.
const WIDTH: usize = 80;
/// What stands where there is nothing.
const NOTHING: &str = "-";
/// Below this many states nothing is said to be the same in all of them.
const SEVERAL: usize = 3;

/// A few columns of the states of a model.
pub(crate) struct ModelStates {
    pub name: &'static str,
    /// What the numbers are of several surfaces; empty for one.
    pub of_surfaces: String,
    pub heads: Vec<Head>,
    /// Cells of the table, one row a state.
    pub rows: Vec<Vec<String>>,
    /// States that are left to the files.
    pub left_out: usize,
    /// What is the same in all states, in words.
    pub same: Vec<String>,
    /// What the numbers behind ± are; empty where there are none.
    pub errors: &'static str,
    /// What is told of each path as a whole, one line a surface or one of means.
    pub of_paths: Vec<String>,
}

/// The head of a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Head {
    pub name: String,
    /// Of its numbers; empty for a pure number.
    pub unit: String,
}

impl Head {
    /// In a line.
    fn text(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{} [{}]", self.name, self.unit) }
    }

    /// In lines of at most this many characters where words allow it, the unit at the end.
    fn lines(&self, width: usize) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in self.name.split('_') {
            match lines.last_mut() {
                Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                    line.push('_');
                    line.push_str(word);
                }
                Some(line) => {
                    line.push('_');
                    lines.push(word.to_owned());
                }
                None => lines.push(word.to_owned()),
            }
        }
        if !self.unit.is_empty() {
            lines.push(format!("[{}]", self.unit));
        }
        lines
    }
}

/// The states of each model as aligned text of at most 80 characters a line where the words allow it.
pub(crate) fn summary(states: &StateTable<'_>) -> String {
    let mut text = String::new();
    // Terminals and fonts without these are still in use, and scenes are written with `um`.
    let plain = |text: &str| text.replace('µ', "u").replace(PLUS_MINUS, "+-");
    for mut model in of_models(states) {
        // A run that was stopped before its first state.
        if model.rows.is_empty() {
            continue;
        }
        model.heads.iter_mut().for_each(|head| head.unit = plain(&head.unit));
        model.rows.iter_mut().flatten().for_each(|cell| *cell = plain(cell));
        let brackets = if model.of_surfaces.is_empty() { "" } else { ": " };
        text += &runs::folded(&format!("{}{brackets}{}\n", model.name, plain(&model.of_surfaces)));
        text += &table_text(&model.heads, &model.rows);
        if model.left_out > 0 {
            text += &format!("  ... {} more states\n", model.left_out);
        }
        if !model.same.is_empty() {
            text += &runs::folded(&plain(&format!("  in all states: {}\n", model.same.join(", "))));
        }
        for line in model.of_paths {
            text += &format!("  {}\n", plain(&line));
        }
        if !model.errors.is_empty() {
            text += &runs::folded(&plain(&format!("  {}\n", model.errors)));
        }
    }
    text
}

/// A table as text: quantities below each other where that is narrower, else columns in as many blocks as the
/// width of a terminal asks for, the first column in each.
fn table_text(heads: &[Head], rows: &[Vec<String>]) -> String {
    let count = |text: &str| text.chars().count();
    let widest = |column: usize| rows.iter().map(|row| count(&row[column])).max().unwrap_or(0);
    let names: Vec<String> = heads.iter().map(Head::text).collect();
    let first = names.iter().map(|name| count(name)).max().unwrap_or(0);
    let width = (0..heads.len()).map(widest).max().unwrap_or(0);
    if is_short(heads.len(), rows.len()) && 2 + first + rows.len() * (2 + width) <= WIDTH {
        let line = |(column, name): (usize, &String)| {
            let cells: String = rows.iter().map(|row| format!("  {:>width$}", row[column])).collect();
            format!("  {name:first$}{cells}\n")
        };
        return names.iter().enumerate().map(line).collect();
    }
    // Heads take the lines that they need not to be wider than the numbers.
    let heads: Vec<Vec<String>> =
        heads.iter().enumerate().map(|(column, head)| head.lines(widest(column).max(8))).collect();
    let widths: Vec<usize> = (heads.iter().enumerate())
        .map(|(column, lines)| lines.iter().map(|line| count(line)).max().unwrap_or(0).max(widest(column)))
        .collect();
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    let mut used = 0;
    for (column, width) in widths.iter().enumerate() {
        match blocks.last_mut() {
            Some(block) if used + 2 + width <= WIDTH || block.len() < 2 => {
                block.push(column);
                used += 2 + width;
            }
            Some(_) => {
                blocks.push(vec![0, column]);
                used = 2 + widths[0] + 2 + width;
            }
            None => {
                blocks.push(vec![column]);
                used = 2 + width;
            }
        }
    }
    let mut text = String::new();
    for block in blocks {
        let mut line = |cell: &dyn Fn(usize) -> String| {
            let cells: String =
                block.iter().map(|&i| format!("  {:>width$}", cell(i), width = widths[i])).collect();
            text += cells.trim_end();
            text.push('\n');
        };
        let deepest = block.iter().map(|&column| heads[column].len()).max().unwrap_or(0);
        for i in 0..deepest {
            // Units stand in one line.
            line(&|column| {
                (i + heads[column].len())
                    .checked_sub(deepest)
                    .map_or_else(String::new, |i| heads[column][i].clone())
            });
        }
        for row in rows {
            line(&|column| row[column].clone());
        }
    }
    text
}

/// Whether a table is read with its quantities below each other: few states have many of them.
pub(crate) fn is_short(columns: usize, states: usize) -> bool {
    states <= 5 && states + 1 < columns
}

/// A number of a state in the summary: a quantity, or its estimated discretisation error.
#[derive(Clone, Copy)]
enum Shown {
    Answer(&'static StateQuantity),
    GridError(&'static StateQuantity),
}

/// What stands in a cell before its column has a unit.
enum Cell {
    Nothing,
    Word(String),
    /// With half of its interval.
    Number(f64, Option<f64>),
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Nothing, |value| Self::Number(value, None))
    }
}

/// Every answer that a scene asks for, each followed by the mean error of its grid, which means over surfaces
/// have.
fn shown(scene: &SceneFile) -> Vec<Shown> {
    let mut shown = Vec::new();
    for quantity in columns::asked(scene).filter(|quantity| quantity.role == Role::Answer) {
        shown.push(Shown::Answer(quantity));
        if columns::with_grid_errors(scene).any(|compared| compared.name == quantity.name) {
            shown.push(Shown::GridError(quantity));
        }
    }
    shown
}

/// Names of the answers that are shown, those of paths as a whole among them.
#[cfg(test)]
pub(crate) fn names(scene: &SceneFile) -> impl Iterator<Item = &'static str> {
    let of_paths = columns::asked(scene).filter(|quantity| quantity.role == Role::OfPath);
    let of_paths: Vec<Shown> = of_paths.map(Shown::Answer).collect();
    shown(scene).into_iter().chain(of_paths).filter_map(|of| match of {
        Shown::Answer(quantity) => Some(quantity.name),
        Shown::GridError(_) => None,
    })
}

impl Shown {
    fn name(self) -> &'static str {
        match self {
            Self::Answer(quantity) => quantity.name,
            Self::GridError(quantity) => quantity.columns[2],
        }
    }

    /// Of its column in files; shares are read in per cent.
    fn unit(self, scene: &SceneFile) -> &'static str {
        match self {
            Self::Answer(StateQuantity { name: "contact_fraction", .. }) | Self::GridError(_) => "%",
            Self::Answer(StateQuantity { unit: QuantityUnit::Word | QuantityUnit::One, .. }) => "",
            Self::Answer(quantity) => columns::column(scene, quantity).unit,
        }
    }

    fn of_state(self, record: &StateRecord) -> Cell {
        let value = match self {
            Self::Answer(quantity) => columns::value(record, quantity),
            Self::GridError(quantity) => {
                let grid = record.solved().and_then(|solved| solved.grid.as_ref());
                grid.and_then(|grid| grid.of(quantity.name)).map(|error| error.error).into()
            }
        };
        match value {
            Value::Number(v) => {
                let error = match self {
                    Self::Answer(quantity) => relative_error(record, quantity),
                    Self::GridError(_) => None,
                };
                Cell::Number(v, error.map(|error| error * v.abs()))
            }
            Value::Count(n) => Cell::Word(n.to_string()),
            Value::Text(word) => Cell::Word(word),
            _ => Cell::Nothing,
        }
    }

    fn of_mean(self, mean: &Mean) -> Cell {
        let found = match self {
            Self::Answer(quantity) => mean.interval(quantity),
            Self::GridError(quantity) => mean.grid_error(quantity).map(|(error, _)| (error, None)),
        };
        match found {
            // The force is what is prescribed, or its error is rounding.
            Some((mean, half)) => Cell::Number(mean, half.filter(|half| *half >= 1e-9 * mean.abs())),
            None => Cell::Nothing,
        }
    }
}

/// A column with the unit of its files as it is read: one multiple of the unit for all of its cells, that of the
/// largest number, or that of the smallest where it spares powers of ten.
fn read_column(unit: &str, cells: &[Cell]) -> (String, Vec<String>) {
    /// Numbers in these limits have no power of ten.
    const PLAIN: [f64; 2] = [1e-2, 1e5];
    let sizes = || {
        let number = |cell: &Cell| match cell {
            Cell::Number(value, _) => Some(value.abs()).filter(|size| size.is_finite() && *size > 0.0),
            _ => None,
        };
        cells.iter().filter_map(number)
    };
    let (smallest, largest) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
    let (shown, factor) = match unit {
        "%" => ("%".to_owned(), 100.0),
        unit => {
            let (coarse, fine) = (multiple(unit, largest), multiple(unit, smallest));
            let finer = smallest * coarse.1 < PLAIN[0] && largest * fine.1 < PLAIN[1];
            if finer { fine } else { coarse }
        }
    };
    let text = |cell: &Cell| match cell {
        Cell::Nothing => NOTHING.to_owned(),
        Cell::Word(word) => word.clone(),
        Cell::Number(value, Some(half)) => with_error(factor * value, factor * half),
        Cell::Number(value, None) => short(factor * value),
    };
    (shown, cells.iter().map(text).collect())
}

/// A share in per cent, two digits.
fn percent(share: f64) -> String {
    format!("{} %", number(rounded(100.0 * share, 2)))
}

/// The columns of a model's table that say something.
#[derive(Default)]
struct TableColumns {
    heads: Vec<Head>,
    /// The cells of each column.
    texts: Vec<Vec<String>>,
    /// What is the same in every row, each in a line of its own.
    same: Vec<String>,
}

impl TableColumns {
    /// From names, units and cells. The first one, of what is prescribed, always stays.
    fn of<'a>(columns: impl Iterator<Item = (&'a str, &'static str, Vec<Cell>)>) -> Self {
        let mut table = Self::default();
        for (i, (name, unit, cells)) in columns.enumerate() {
            let (unit, cells) = read_column(unit, &cells);
            let unit = if ["scene", "1"].contains(&&*unit) { String::new() } else { unit };
            // A column without anything says nothing, and neither do the zeros of a time that does not pass.
            let empty = cells.iter().all(|cell| cell == NOTHING)
                || name == "time" && cells.iter().all(|cell| cell == "0");
            if i > 0 && empty {
                continue;
            }
            if i > 0 && cells.len() >= SEVERAL && cells.iter().all(|cell| *cell == cells[0]) {
                table.same.push(format!("{name} {} {unit}", cells[0]).trim_end().to_owned());
                continue;
            }
            table.heads.push(Head { name: name.to_owned(), unit });
            table.texts.push(cells);
        }
        table
    }
}

/// The answers of each model; of several surfaces their means with half of their intervals.
pub(crate) fn of_models(table: &StateTable<'_>) -> Vec<ModelStates> {
    let StateTable { scene, means, .. } = table;
    let prescribed = match &scene.request {
        LoadRequest::Loads(LoadList { kind, .. }) => Some((kind.key(), kind.unit())),
        LoadRequest::Path(_) => None,
    };
    // What is prescribed stands there once.
    let shown: Vec<Shown> =
        shown(scene).into_iter().filter(|of| Some(of.name()) != prescribed.map(|(key, _)| key)).collect();
    let of_model = |name: &'static str| {
        let states = || table.of_model(name);
        let means = || means.iter().filter(move |mean| mean.model == name);
        let averaged = means().next().is_some();
        let column =
            |of_state: &dyn Fn(&StateRecord) -> Cell, of_mean: &dyn Fn(&Mean) -> Cell| -> Vec<Cell> {
                states().filter(|_| !averaged).map(of_state).chain(means().map(of_mean)).collect()
            };
        let first = if let Some((key, unit)) = prescribed {
            let of_state = |record: &StateRecord| scene.request.prescribed(record.index).into();
            (key, scene.system.unit(unit), column(&of_state, &|mean| mean.prescribed.into()))
        } else {
            let step = |index: usize| Cell::Word(index.to_string());
            ("state", "", column(&|record| step(record.index), &|mean| step(mean.state)))
        };
        // In a state the error of the grid stands behind its number; behind a mean there is the interval of
        // the mean.
        let columns = shown.iter().filter(|of| averaged || matches!(of, Shown::Answer(_)));
        let rest = columns.map(|of| {
            (of.name(), of.unit(scene), column(&|record| of.of_state(record), &|mean| of.of_mean(mean)))
        });
        let TableColumns { heads, texts, same } = TableColumns::of(std::iter::once(first).chain(rest));
        let count = texts.first().map_or(0, Vec::len);
        let compared = states().any(|record| record.solved().is_some_and(|solved| solved.grid.is_some()));
        let errors = if averaged || !texts.iter().flatten().any(|cell| cell.contains(PLUS_MINUS)) {
            ""
        } else if compared && scene.is_unconfirmed {
            OF_GRID_UNCONFIRMED
        } else if compared {
            OF_GRID
        } else {
            OF_SOLVER
        };
        ModelStates {
            name,
            of_surfaces: ensemble::words(means()),
            heads,
            rows: (0..count.min(MOST))
                .map(|row| texts.iter().map(|column| column[row].clone()).collect())
                .collect(),
            left_out: count.saturating_sub(MOST),
            same,
            errors,
            of_paths: of_paths(table, name, means().next_back()),
        }
    };
    scene.models.iter().map(crate::scenes::Numerics::name).map(of_model).collect()
}

/// What a model's paths are as a whole: the quantities of paths at their ends and the energy of each cycle, in words.
fn of_paths(table: &StateTable<'_>, model: &str, mean: Option<&Mean>) -> Vec<String> {
    let StateTable { scene, units, .. } = table;
    let quantities: Vec<&'static StateQuantity> =
        columns::asked(scene).filter(|quantity| quantity.role == Role::OfPath).collect();
    let line = |of: &dyn Fn(Shown) -> Cell| {
        let known = quantities.iter().filter_map(|&quantity| {
            let shown = Shown::Answer(quantity);
            let value = match of(shown) {
                Cell::Nothing => return None,
                Cell::Word(word) => word,
                Cell::Number(value, half) => {
                    let half = half.map(|half| format!(" ± {}", percent(half / value.abs())));
                    amount(value, shown.unit(scene)) + &half.unwrap_or_default()
                }
            };
            Some(format!("{} {value}", quantity.name))
        });
        known.collect::<Vec<_>>().join(", ")
    };
    let mut lines: Vec<String> = if let Some(mean) = mean {
        vec![line(&|shown| shown.of_mean(mean))]
    } else {
        let of_model = units.iter().filter(|unit| unit.model == model);
        let ends = of_model.filter_map(|unit| unit.states.iter().rfind(|record| record.solved().is_some()));
        ends.map(|end| line(&|shown| shown.of_state(end))).collect()
    };
    lines.retain(|line| !line.is_empty());
    let of_whole = lines.into_iter().map(|line| format!("path as a whole: {line}"));
    of_whole.chain(cycles::lines(table, model)).chain(thresholds::lines(table, model)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(name: &str, unit: &str) -> Head {
        Head { name: name.into(), unit: unit.into() }
    }

    #[test]
    fn a_column_has_one_unit() {
        let numbers = |values: &[f64]| values.iter().map(|v| Cell::Number(*v, None)).collect::<Vec<_>>();
        assert_eq!(
            read_column("m^2", &numbers(&[2.5e-12, 1.9e-11, 1.7e-10])),
            ("µm^2".to_owned(), ["2.500", "19.00", "170.0"].map(str::to_owned).to_vec())
        );
        assert_eq!(read_column("m^2", &numbers(&[3.857e-10, 0.0, 3.856e-8])).1, ["385.7", "0", "38560"]);
        assert_eq!(read_column("N", &numbers(&[1e-20, 3.0])).1, ["1.000e-20", "3.000"]);
        assert_eq!(read_column("%", &numbers(&[0.295_2, 1.5])).1, ["29.52", "150.0"]);
        let cells = [Cell::Nothing, Cell::Number(-2e-3, Some(1.38e-4)), Cell::Word("a".into())];
        assert_eq!(
            read_column("N", &cells),
            ("mN".to_owned(), ["-", "-2.00 ± 0.14", "a"].map(str::to_owned).to_vec())
        );
        assert_eq!(read_column("scene", &numbers(&[2e-7])).1, ["2.000e-7"]);
    }

    #[test]
    fn a_table_fits_a_terminal() {
        let heads: Vec<Head> = (0..9).map(|i| head(&format!("tangential_displacement_{i}"), "nm")).collect();
        for states in [1, 3, 5, 6, 20] {
            let rows: Vec<Vec<String>> =
                (0..states).map(|row| (0..9).map(|i| format!("{row}.{i}00")).collect()).collect();
            let text = table_text(&heads, &rows);
            assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
            for cell in rows.iter().flatten() {
                assert!(text.contains(cell.as_str()), "{cell} in\n{text}");
            }
        }
        // Heads stand above their columns, units in one line; the first column in every block.
        let rows = vec![vec!["1".to_owned(); 9]; 20];
        let text = table_text(&heads, &rows);
        assert_eq!(
            text.lines().next().map(str::trim_start),
            Some("tangential_    tangential_    tangential_    tangential_    tangential_")
        );
        // Two blocks: three lines of words and one of units above twenty rows in each.
        assert_eq!((text.lines().count(), text.matches("[nm]").count()), (2 * 24, 10));
        let few = table_text(&heads[..2], &rows[..1].iter().map(|row| row[..2].to_vec()).collect::<Vec<_>>());
        assert_eq!(few.lines().count(), 4 + 1, "{few}");
    }
}
