//! The curve of a tangential load with its reversals: first loading, doubled branches and closed loops
//! (Mindlin and Deresiewicz).

/// `u = 1 - (1 - t)^(2/3)`: displacement of first loading over its reach, t in [0, 1].
pub(crate) fn reached(t: f64) -> f64 {
    if t >= 1.0 { 1.0 } else { -(2.0 / 3.0 * (-t).ln_1p()).exp_m1() }
}

/// `t = 1 - (1 - u)^(3/2)`, its inverse.
pub(crate) fn held(u: f64) -> f64 {
    if u >= 1.0 { 1.0 } else { -(1.5 * (-u).ln_1p()).exp_m1() }
}

/// Energy that first loading dissipates, over mu F and the reach:
/// `(6/5) (1 - (1 - t)^(5/3)) - t (1 + (1 - t)^(2/3))`.
///
/// By its power series `t^3/27 + ...` where the closed form cancels.
pub(crate) fn lost(t: f64) -> f64 {
    const SMALL: f64 = 0.3;
    if t > SMALL {
        let q = 1.0 - reached(t);
        return 1.2 * (1.0 - (1.0 - t) * q) - t * (1.0 + q);
    }
    // (1 - t)^b = sum of c_k t^k with c_k = c_(k - 1) (k - 1 - b)/k.
    let (mut five, mut two) = (1.0, 1.0);
    let mut power = 1.0;
    let mut sum = 0.0;
    for k in 1..=40 {
        let k = f64::from(k);
        let last = two;
        five *= (k - 1.0 - 5.0 / 3.0) / k;
        two *= (k - 1.0 - 2.0 / 3.0) / k;
        power *= t;
        // The terms of first and second order cancel exactly.
        if k > 2.5 {
            sum += (-1.2 * five - last) * power;
        }
    }
    sum
}

/// A point of the curve: force over mu F, displacement over the reach.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct MemoryPoint {
    pub t: f64,
    pub u: f64,
}

/// Where a branch is left: at a force or at a displacement.
#[derive(Debug, Clone, Copy)]
pub(crate) enum SlipLoad {
    Force(f64),
    Displacement(f64),
}

impl SlipLoad {
    fn from(self, point: MemoryPoint) -> f64 {
        match self {
            Self::Force(t) => t - point.t,
            Self::Displacement(u) => u - point.u,
        }
    }
}

/// The curve so far.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct SlipCurve {
    pub now: MemoryPoint,
    /// Sign of the last motion, 0 before any.
    direction: f64,
    /// Turns that are not closed, the first one on the curve of first loading.
    pub turns: Vec<MemoryPoint>,
    /// Displacement at which first loading begins: it moves with gross slip.
    origin: f64,
    /// Over mu F and the reach.
    pub dissipated: f64,
}

impl SlipCurve {
    /// Moves to a goal; a force is within [-1, 1].
    pub fn go(&mut self, goal: SlipLoad) {
        let way = goal.from(self.now);
        if way.abs() <= 0.0 {
            return;
        }
        let direction = way.signum();
        if direction * self.direction < 0.0 {
            self.turns.push(self.now);
        }
        self.direction = direction;
        loop {
            // Where this branch ends, and the turn before its own that is closed there.
            let end = match self.turns[..] {
                [] => MemoryPoint { t: direction, u: self.origin + direction },
                // Back to first loading on the other side.
                [turn] => MemoryPoint { t: -turn.t, u: 2.0 * self.origin - turn.u },
                [.., earlier, _] => earlier,
            };
            if goal.from(end) * direction < 0.0 {
                self.along(goal);
                return;
            }
            let before = self.now;
            self.along(SlipLoad::Force(end.t));
            // The same point, without the rounding of the branch.
            self.now = end;
            if self.turns.is_empty() {
                if let SlipLoad::Displacement(u) = goal {
                    self.dissipated += (u - end.u).abs();
                    self.now.u = u;
                    self.origin = u - direction;
                }
                return;
            }
            self.turns.truncate(self.turns.len().saturating_sub(2));
            if before == self.now && goal.from(self.now).abs() <= 0.0 {
                return;
            }
        }
    }

    /// Moves along the branch that begins at the last turn: the first curve, doubled.
    fn along(&mut self, goal: SlipLoad) {
        let (start, scale) = match self.turns.last() {
            Some(turn) => (*turn, 2.0),
            None => (MemoryPoint { t: 0.0, u: self.origin }, 1.0),
        };
        let share = |t: f64| ((t - start.t).abs() / scale).min(1.0);
        let before = lost(share(self.now.t));
        self.now = match goal {
            SlipLoad::Force(t) => MemoryPoint { t, u: start.u + self.direction * scale * reached(share(t)) },
            SlipLoad::Displacement(u) => {
                let part = ((u - start.u).abs() / scale).min(1.0);
                MemoryPoint { t: start.t + self.direction * scale * held(part), u }
            }
        };
        self.dissipated += scale * (lost(share(self.now.t)) - before).max(0.0);
    }

    /// Stick radius over contact radius.
    pub fn stick(&self) -> f64 {
        let (start, scale) = self.turns.last().map_or((0.0, 1.0), |turn| (turn.t, 2.0));
        (1.0 - ((self.now.t - start).abs() / scale).min(1.0)).cbrt()
    }
}
