"""The columns of a table of states. Written by python/generate.py from the table of quantities."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


class Columns:
    """A property for each quantity that a table of states may show, in its order."""

    results: dict[str, NDArray[Any]]

    def _column(self, name: str) -> NDArray[np.float64]:
        known = self.results.get(name)
        count = len(self.results["state"])
        return np.full(count, np.nan) if known is None else np.asarray(known, dtype=np.float64)

    def _words(self, name: str) -> NDArray[np.str_]:
        known = self.results.get(name)
        count = len(self.results["state"])
        return np.full(count, "") if known is None else np.asarray(known, dtype=np.str_)

    @property
    def time(self) -> NDArray[np.float64]:
        """numpy.ndarray: time in s for SI units, shape (states,); NaN where there is none."""
        return self._column("time")

    @property
    def force(self) -> NDArray[np.float64]:
        """numpy.ndarray: force in N for SI units, shape (states,); NaN where there is none."""
        return self._column("force")

    @property
    def approach(self) -> NDArray[np.float64]:
        """numpy.ndarray: approach in m for SI units, shape (states,); NaN where there is none."""
        return self._column("approach")

    @property
    def mean_gap(self) -> NDArray[np.float64]:
        """numpy.ndarray: mean gap in m for SI units, shape (states,); NaN where there is none."""
        return self._column("mean_gap")

    @property
    def whole_approach(self) -> NDArray[np.float64]:
        """numpy.ndarray: approach with the whole layer in m for SI units, shape (states,); NaN where there is none."""
        return self._column("whole_approach")

    @property
    def contact_radius(self) -> NDArray[np.float64]:
        """numpy.ndarray: contact radius in m for SI units, shape (states,); NaN where there is none."""
        return self._column("contact_radius")

    @property
    def tangential_force(self) -> NDArray[np.float64]:
        """numpy.ndarray: tangential force in N for SI units, shape (states,); NaN where there is none."""
        return self._column("tangential_force")

    @property
    def tangential_force_y(self) -> NDArray[np.float64]:
        """numpy.ndarray: tangential force along y in N for SI units, shape (states,); NaN where there is none."""
        return self._column("tangential_force_y")

    @property
    def tangential_displacement(self) -> NDArray[np.float64]:
        """numpy.ndarray: tangential displacement in m for SI units, shape (states,); NaN where there is none."""
        return self._column("tangential_displacement")

    @property
    def tangential_displacement_y(self) -> NDArray[np.float64]:
        """numpy.ndarray: tangential displacement along y in m for SI units, shape (states,); NaN where there is
        none."""
        return self._column("tangential_displacement_y")

    @property
    def sliding_force(self) -> NDArray[np.float64]:
        """numpy.ndarray: sliding force in N for SI units, shape (states,); NaN where there is none."""
        return self._column("sliding_force")

    @property
    def stick_area(self) -> NDArray[np.float64]:
        """numpy.ndarray: stick area in m^2 for SI units, shape (states,); NaN where there is none."""
        return self._column("stick_area")

    @property
    def slip_area(self) -> NDArray[np.float64]:
        """numpy.ndarray: slip area in m^2 for SI units, shape (states,); NaN where there is none."""
        return self._column("slip_area")

    @property
    def tangential_stiffness(self) -> NDArray[np.float64]:
        """numpy.ndarray: tangential stiffness in N/m for SI units, shape (states,); NaN where there is none."""
        return self._column("tangential_stiffness")

    @property
    def tangential_stiffness_xy(self) -> NDArray[np.float64]:
        """numpy.ndarray: tangential stiffness, x of y in N/m for SI units, shape (states,); NaN where there is none."""
        return self._column("tangential_stiffness_xy")

    @property
    def tangential_stiffness_y(self) -> NDArray[np.float64]:
        """numpy.ndarray: tangential stiffness along y in N/m for SI units, shape (states,); NaN where there is none."""
        return self._column("tangential_stiffness_y")

    @property
    def tangential_stiffness_stuck(self) -> NDArray[np.float64]:
        """numpy.ndarray: tangential stiffness, sticking in N/m for SI units, shape (states,); NaN where there is
        none."""
        return self._column("tangential_stiffness_stuck")

    @property
    def tangential_stiffness_stuck_xy(self) -> NDArray[np.float64]:
        """numpy.ndarray: tangential stiffness, sticking, x of y in N/m for SI units, shape (states,); NaN where there
        is none."""
        return self._column("tangential_stiffness_stuck_xy")

    @property
    def tangential_stiffness_stuck_y(self) -> NDArray[np.float64]:
        """numpy.ndarray: tangential stiffness along y, sticking in N/m for SI units, shape (states,); NaN where there
        is none."""
        return self._column("tangential_stiffness_stuck_y")

    @property
    def stick_radius(self) -> NDArray[np.float64]:
        """numpy.ndarray: stick radius in m for SI units, shape (states,); NaN where there is none."""
        return self._column("stick_radius")

    @property
    def dissipated(self) -> NDArray[np.float64]:
        """numpy.ndarray: energy dissipated by friction in J for SI units, shape (states,); NaN where there is none."""
        return self._column("dissipated")

    @property
    def plastic_area(self) -> NDArray[np.float64]:
        """numpy.ndarray: area under the hardness in m^2 for SI units, shape (states,); NaN where there is none."""
        return self._column("plastic_area")

    @property
    def plastic_volume(self) -> NDArray[np.float64]:
        """numpy.ndarray: volume of the plastic indentation in m^3 for SI units, shape (states,); NaN where there is
        none."""
        return self._column("plastic_volume")

    @property
    def plastic_work(self) -> NDArray[np.float64]:
        """numpy.ndarray: plastic work in J for SI units, shape (states,); NaN where there is none."""
        return self._column("plastic_work")

    @property
    def work(self) -> NDArray[np.float64]:
        """numpy.ndarray: work of the load in J for SI units, shape (states,); NaN where there is none."""
        return self._column("work")

    @property
    def branch(self) -> NDArray[np.str_]:
        """numpy.ndarray: branch, shape (states,); empty where there is none."""
        return self._words("branch")

    @property
    def energy(self) -> NDArray[np.float64]:
        """numpy.ndarray: energy in J for SI units, shape (states,); NaN where there is none."""
        return self._column("energy")

    @property
    def stability(self) -> NDArray[np.float64]:
        """numpy.ndarray: stability, a pure number, shape (states,); NaN where there is none."""
        return self._column("stability")

    @property
    def pull_off(self) -> NDArray[np.float64]:
        """numpy.ndarray: largest pull in N for SI units, shape (states,); NaN where there is none."""
        return self._column("pull_off")

    @property
    def pull_off_error(self) -> NDArray[np.float64]:
        """numpy.ndarray: error of the largest pull in N for SI units, shape (states,); NaN where there is none."""
        return self._column("pull_off_error")

    @property
    def pull_off_approach(self) -> NDArray[np.float64]:
        """numpy.ndarray: approach at the largest pull in m for SI units, shape (states,); NaN where there is none."""
        return self._column("pull_off_approach")

    @property
    def pull_off_mean_gap(self) -> NDArray[np.float64]:
        """numpy.ndarray: mean gap at the largest pull in m for SI units, shape (states,); NaN where there is none."""
        return self._column("pull_off_mean_gap")

    @property
    def stiffness(self) -> NDArray[np.float64]:
        """numpy.ndarray: stiffness in N/m for SI units, shape (states,); NaN where there is none."""
        return self._column("stiffness")

    @property
    def whole_stiffness(self) -> NDArray[np.float64]:
        """numpy.ndarray: stiffness with the whole layer in N/m for SI units, shape (states,); NaN where there is
        none."""
        return self._column("whole_stiffness")

    @property
    def stiffness_fixed_area(self) -> NDArray[np.float64]:
        """numpy.ndarray: stiffness at fixed contact area in N/m for SI units, shape (states,); NaN where there is
        none."""
        return self._column("stiffness_fixed_area")

    @property
    def area(self) -> NDArray[np.float64]:
        """numpy.ndarray: contact area in m^2 for SI units, shape (states,); NaN where there is none."""
        return self._column("area")

    @property
    def area_corrected(self) -> NDArray[np.float64]:
        """numpy.ndarray: corrected area in m^2 for SI units, shape (states,); NaN where there is none."""
        return self._column("area_corrected")

    @property
    def contact_fraction(self) -> NDArray[np.float64]:
        """numpy.ndarray: contact fraction, a pure number, shape (states,); NaN where there is none."""
        return self._column("contact_fraction")

    @property
    def conductance(self) -> NDArray[np.float64]:
        """numpy.ndarray: conductance in S, W/K for SI units, shape (states,); NaN where there is none."""
        return self._column("conductance")

    @property
    def film_conductance(self) -> NDArray[np.float64]:
        """numpy.ndarray: conductance with the film in S, W/K for SI units, shape (states,); NaN where there is none."""
        return self._column("film_conductance")

    @property
    def film_conductance_per_area(self) -> NDArray[np.float64]:
        """numpy.ndarray: conductance with the film, per area in S/m^2, W/(m^2 K) for SI units, shape (states,); NaN
        where there is none."""
        return self._column("film_conductance_per_area")

    @property
    def film_conductance_along(self) -> NDArray[np.float64]:
        """numpy.ndarray: conductance of the film along the interface in S, W/K for SI units, shape (states,); NaN where
        there is none."""
        return self._column("film_conductance_along")

    @property
    def leakage(self) -> NDArray[np.float64]:
        """numpy.ndarray: leakage in m^3/s for SI units, shape (states,); NaN where there is none."""
        return self._column("leakage")

    @property
    def leakage_lower(self) -> NDArray[np.float64]:
        """numpy.ndarray: lower bound of the leakage in m^3/s for SI units, shape (states,); NaN where there is none."""
        return self._column("leakage_lower")

    @property
    def leakage_upper(self) -> NDArray[np.float64]:
        """numpy.ndarray: upper bound of the leakage in m^3/s for SI units, shape (states,); NaN where there is none."""
        return self._column("leakage_upper")

    @property
    def flow_factor(self) -> NDArray[np.float64]:
        """numpy.ndarray: flow factor, a pure number, shape (states,); NaN where there is none."""
        return self._column("flow_factor")

    @property
    def open_along_x(self) -> NDArray[np.float64]:
        """numpy.ndarray: open path along x, a pure number, shape (states,); NaN where there is none."""
        return self._column("open_along_x")

    @property
    def open_along_y(self) -> NDArray[np.float64]:
        """numpy.ndarray: open path along y, a pure number, shape (states,); NaN where there is none."""
        return self._column("open_along_y")

    @property
    def contact_along_x(self) -> NDArray[np.float64]:
        """numpy.ndarray: path of contact along x, a pure number, shape (states,); NaN where there is none."""
        return self._column("contact_along_x")

    @property
    def contact_along_y(self) -> NDArray[np.float64]:
        """numpy.ndarray: path of contact along y, a pure number, shape (states,); NaN where there is none."""
        return self._column("contact_along_y")

    @property
    def constriction_x(self) -> NDArray[np.float64]:
        """numpy.ndarray: critical constriction along x in m for SI units, shape (states,); NaN where there is none."""
        return self._column("constriction_x")

    @property
    def constriction_x_at_x(self) -> NDArray[np.float64]:
        """numpy.ndarray: place x of the constriction along x in m for SI units, shape (states,); NaN where there is
        none."""
        return self._column("constriction_x_at_x")

    @property
    def constriction_x_at_y(self) -> NDArray[np.float64]:
        """numpy.ndarray: place y of the constriction along x in m for SI units, shape (states,); NaN where there is
        none."""
        return self._column("constriction_x_at_y")

    @property
    def constriction_y(self) -> NDArray[np.float64]:
        """numpy.ndarray: critical constriction along y in m for SI units, shape (states,); NaN where there is none."""
        return self._column("constriction_y")

    @property
    def constriction_y_at_x(self) -> NDArray[np.float64]:
        """numpy.ndarray: place x of the constriction along y in m for SI units, shape (states,); NaN where there is
        none."""
        return self._column("constriction_y_at_x")

    @property
    def constriction_y_at_y(self) -> NDArray[np.float64]:
        """numpy.ndarray: place y of the constriction along y in m for SI units, shape (states,); NaN where there is
        none."""
        return self._column("constriction_y_at_y")

    @property
    def largest_von_mises(self) -> NDArray[np.float64]:
        """numpy.ndarray: largest stress below the surface in Pa for SI units, shape (states,); NaN where there is
        none."""
        return self._column("largest_von_mises")

    @property
    def largest_von_mises_depth(self) -> NDArray[np.float64]:
        """numpy.ndarray: depth of the largest stress in m for SI units, shape (states,); NaN where there is none."""
        return self._column("largest_von_mises_depth")

    @property
    def largest_von_mises_x(self) -> NDArray[np.float64]:
        """numpy.ndarray: place x of the largest stress in m for SI units, shape (states,); NaN where there is none."""
        return self._column("largest_von_mises_x")

    @property
    def largest_von_mises_y(self) -> NDArray[np.float64]:
        """numpy.ndarray: place y of the largest stress in m for SI units, shape (states,); NaN where there is none."""
        return self._column("largest_von_mises_y")

    @property
    def factor_until_yield(self) -> NDArray[np.float64]:
        """numpy.ndarray: factor until yield, a pure number, shape (states,); NaN where there is none."""
        return self._column("factor_until_yield")

    @property
    def patches(self) -> NDArray[np.float64]:
        """numpy.ndarray: number of contacts, a pure number, shape (states,); NaN where there is none."""
        return self._column("patches")

    @property
    def largest_patch(self) -> NDArray[np.float64]:
        """numpy.ndarray: area of the largest contact in m^2 for SI units, shape (states,); NaN where there is none."""
        return self._column("largest_patch")

    @property
    def largest_pressure(self) -> NDArray[np.float64]:
        """numpy.ndarray: largest pressure in Pa for SI units, shape (states,); NaN where there is none."""
        return self._column("largest_pressure")

    @property
    def contact_cells(self) -> NDArray[np.float64]:
        """numpy.ndarray: contact cells, a pure number, shape (states,); NaN where there is none."""
        return self._column("contact_cells")
