"""Random arrays that describe themselves, as other programs write them, against what other programs read.

Writes HDF5 (h5py), NetCDF-3 (scipy), NetCDF-4 (netCDF4) and TIFF (tifffile) with random orders of the axes,
coordinates, types of numbers, scales, offsets, marks of undefined points, layouts and compressions, and
compares the heights of `cargo run -p surface-io --example channels` with those that xarray and rasterio read.

    python compare.py CHANNELS NUMBER [SEED]

CHANNELS is the built example, NUMBER how many files are written. Ends with 1 where heights differ; the files are
kept then, and their names are printed.
"""

import pathlib
import subprocess
import sys
import tempfile
import warnings

import h5py
import netCDF4
import numpy as np
import rasterio
import scipy.io
import tifffile
import xarray

# Files without a place on the Earth, and with two marks of undefined points, are meant.
warnings.simplefilter("ignore")
X = {"x", "lon", "easting", "column"}
NAMES = [("y", "x"), ("x", "y"), ("lat", "lon"), ("lon", "lat"), ("row", "column"), ("easting", "northing"), ("a", "b")]
LENGTHS = {"m": 1.0, "um": 1e-6, "mm": 1e-3}


class Made:
    """A random array and what is said about it."""

    def __init__(self, rng, kinds):
        self.rng = rng
        self.names = NAMES[rng.integers(len(NAMES))]
        self.shape = tuple(int(n) for n in rng.choice(np.arange(2, 9), 2, replace=False))
        self.dtype = np.dtype(rng.choice(kinds))
        if self.dtype.kind == "f":
            self.values = rng.normal(size=self.shape).astype(self.dtype)
        else:
            info = np.iinfo(self.dtype)
            low, high = max(info.min, -(2**31)), min(info.max, 2**31)
            self.values = rng.integers(low, high, self.shape, dtype=np.int64).astype(self.dtype)
        self.attributes = {}
        if rng.random() < 0.5:
            self.attributes["scale_factor"] = float(rng.choice([0.1, 0.25, 1e-9, -2.0]))
        if rng.random() < 0.4:
            self.attributes["add_offset"] = float(rng.choice([-40.0, 1.5, 1e-6]))
        if rng.random() < 0.6:
            self.attributes["units"] = str(rng.choice(["m", "nm", "um"]))
        for name in ("_FillValue", "missing_value"):
            if rng.random() < 0.35:
                mark = rng.choice([-9999.9, -99.0, 1e30]) if self.dtype.kind == "f" else rng.choice([0, 1, 77, 100])
                mark = self.dtype.type(mark)
                self.attributes[name] = mark
                self.values[tuple(rng.integers(n) for n in self.shape)] = mark

        # A range of the numbers as they are stored: netCDF4 masks what is outside of it, xarray does not.
        self.valid = None
        if rng.random() < 0.25:
            low, high = np.sort(rng.choice(self.values.ravel(), 2))
            self.valid = np.array([low, high], self.dtype)

    def coordinates(self):
        """Coordinates along each dimension with their unit, or None."""
        found = {}
        for name, count in zip(self.names, self.shape, strict=True):
            if self.rng.random() < 0.6 and name != "a" and name != "b":
                step = float(self.rng.choice([0.5, -0.25, 2.0, -1.0]))
                unit = str(self.rng.choice([*LENGTHS, "degrees", ""]))
                found[name] = (self.rng.integers(-3, 4) + step * np.arange(count), unit)
        return found


def hdf5(path, rng):
    made = Made(rng, ["f4", "f8", ">f4", "i2", "i4", "u1", "u2", ">i2"])
    with h5py.File(path, "w") as file:
        layout = {}
        if rng.random() < 0.6:
            layout["chunks"] = tuple(int(rng.integers(1, n + 1)) for n in made.shape)
            if rng.random() < 0.6:
                layout |= {"compression": "gzip", "shuffle": bool(rng.random() < 0.5)}
        data = file.create_dataset("z", data=made.values, **layout)
        for key, value in made.attributes.items():
            data.attrs[key] = value
        coordinates = made.coordinates()
        for i, (name, count) in enumerate(zip(made.names, made.shape, strict=True)):
            values, unit = coordinates.get(name, (None, ""))
            scale = file.create_dataset(name, data=np.zeros(count, "f4") if values is None else values)
            if unit:
                scale.attrs["units"] = unit
            # A dimension without coordinates, as the NetCDF library has it.
            nameless = f"This is a netCDF dimension but not a netCDF variable.{count:10}"
            scale.make_scale(name if values is not None else nameless)
            data.dims[i].attach_scale(scale)
        made.valid = None
    return "netcdf4", made, coordinates


def netcdf(path, rng, three):
    kinds = [">i1", ">i2", ">i4", ">f4", ">f8"] if three else ["i1", "u1", "i2", "u2", "i4", "f4", "f8"]
    made = Made(rng, kinds)
    coordinates = made.coordinates()
    if made.dtype.kind == "i" and rng.random() < 0.3:
        made.attributes["_Unsigned"] = str(rng.choice(["true", "false"]))
    # The name decides about marks in the library of NetCDF-4, which wants the fill value at the beginning.
    fill = made.attributes.pop("_FillValue", None)
    if three:
        file = scipy.io.netcdf_file(path, "w", version=int(rng.choice([1, 2])))
    else:
        file = netCDF4.Dataset(path, "w", format="NETCDF4")
    for name, count in zip(made.names, made.shape, strict=True):
        file.createDimension(name, count)
    if three:
        data = file.createVariable("z", made.dtype, made.names)
        if fill is not None:
            data._FillValue = np.array([fill], made.dtype)
    else:
        zlib = bool(rng.random() < 0.5)
        data = file.createVariable("z", made.dtype, made.names, fill_value=fill, zlib=zlib)
        data.set_auto_maskandscale(False)
    for key, value in made.attributes.items():
        # Of a number alone scipy writes a float32, with which xarray rounds doubles before it looks for marks.
        kind = made.dtype if key == "missing_value" else "f8"
        setattr(data, key, value if isinstance(value, str) else np.array([value], kind))
    if made.valid is not None and "_Unsigned" not in made.attributes:
        if rng.random() < 0.5:
            data.valid_range = made.valid
        else:
            data.valid_min, data.valid_max = made.valid[:1], made.valid[1:]
    else:
        made.valid = None
    data[:] = made.values
    for name, (values, unit) in coordinates.items():
        along = file.createVariable(name, "f8", (name,))
        along[:] = values
        if unit:
            along.units = unit
    file.close()
    return "scipy" if three else "netcdf4", made, coordinates


def tiff(path, rng):
    kinds = ["f4", "f8", "u2", "i2", "i4", "u4"]
    made = Made(rng, kinds)
    made.names = ("y", "x")
    tags, attributes = [], made.attributes
    mark = attributes.get("_FillValue")
    if mark is not None:
        digits = 15 if made.dtype.kind == "f" and rng.random() < 0.5 else 17
        text = f"{float(mark):.{digits}g}"
        tags.append((42113, "s", 0, text, True))
    items = [(name, key) for name, key in (("scale", "scale_factor"), ("offset", "add_offset")) if key in attributes]
    if items:
        item = '<Item name="{}" sample="0" role="{}">{!r}</Item>'
        text = "".join(item.format(name.upper(), name, attributes[key]) for name, key in items)
        tags.append((42112, "s", 0, f"<GDALMetadata>{text}</GDALMetadata>", True))
    options = {"byteorder": str(rng.choice(["<", ">"])), "extratags": tags, "bigtiff": bool(rng.random() < 0.2)}
    compression = rng.choice(["none", "zlib", "lzw"])
    if compression != "none":
        options["compression"] = str(compression)
        if made.dtype.kind != "f" and rng.random() < 0.5:
            options["predictor"] = True
    if rng.random() < 0.3:
        options["tile"] = (16, 16)
    elif rng.random() < 0.5:
        options["rowsperstrip"] = int(rng.integers(1, made.shape[0] + 1))
    tifffile.imwrite(path, made.values, photometric="minisblack", metadata=None, **options)
    return "rasterio", made, {}


def expected(path, engine, made):
    """Heights as y and x, both ascending, by another reader."""
    if engine == "rasterio":
        with rasterio.open(path) as file:
            values = file.read(1, masked=True).astype("f8").filled(np.nan)
            return values * file.scales[0] + file.offsets[0]
    with xarray.open_dataset(path, engine=engine, decode_times=False) as file:
        array = file["z"].astype("f8").load()
    if engine != "rasterio" and made.valid is not None:
        with netCDF4.Dataset(path) as file:
            array = array.where(~np.ma.getmaskarray(file["z"][:]))
    first, second = array.dims
    for name in array.dims:
        if name in array.coords and name not in ("a", "b"):
            array = array.sortby(name)
    # Dimensions of other names are y and x, as the CF conventions order them.
    return array.transpose(second, first).values if first in X else array.values


def compare(line, path, engine, made, coordinates):
    """What is wrong; empty where all agrees."""
    parts = line.split("\t")
    if parts[1] == "error":
        return parts[2]
    _, _, rows, columns, _, cell, heights = parts
    found = np.array(heights.split(), "f8").reshape(int(rows), int(columns))
    wanted = expected(path, engine, made)
    if found.shape != wanted.shape:
        return f"shape {found.shape}, expected {wanted.shape}"
    if not np.array_equal(np.isnan(found), np.isnan(wanted)):
        return f"undefined {np.argwhere(np.isnan(found)).tolist()}, expected {np.argwhere(np.isnan(wanted)).tolist()}"
    # xarray has float32 for packed numbers of 16 bits.
    near = np.nanmax(np.abs(wanted), initial=0.0) * 1e-6
    if not np.allclose(found, wanted, rtol=1e-6, atol=near, equal_nan=True):
        return f"heights\n{found}\nexpected\n{wanted}"
    if len(coordinates) == 2 and all(unit in LENGTHS for _, unit in coordinates.values()):
        steps = {("x" if name in X else "y"): abs(v[1] - v[0]) * LENGTHS[u] for name, (v, u) in coordinates.items()}
        sides = [float(side) for side in cell.split()]
        if not np.allclose(sides, [steps["x"], steps["y"]], rtol=1e-9):
            return f"cells of {cell}, expected {steps}"
    return ""


def main():
    channels, number = sys.argv[1], int(sys.argv[2])
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    rng = np.random.default_rng(seed)
    directory = pathlib.Path(tempfile.mkdtemp(prefix="containers"))
    writers = [
        ("h5", hdf5),
        ("3.nc", lambda path, rng: netcdf(path, rng, True)),
        ("4.nc", lambda path, rng: netcdf(path, rng, False)),
        ("tif", tiff),
    ]
    files = []
    for i in range(number):
        ending, write = writers[i % len(writers)]
        path = directory / f"{i}.{ending}"
        files.append((path, *write(str(path), rng)))
    lines = subprocess.run([channels, *(str(file[0]) for file in files)], capture_output=True, text=True, check=True)
    by_path = {}
    for line in lines.stdout.splitlines():
        # Scales of dimensions are not over two dimensions; the array itself is the only channel.
        by_path.setdefault(line.split("\t")[0], []).append(line)
    wrong = 0
    for path, engine, made, coordinates in files:
        found = by_path.get(str(path), [])
        problem = compare(found[0], path, engine, made, coordinates) if len(found) == 1 else f"{len(found)} channels"
        if problem:
            wrong += 1
            print(f"{path} {made.dtype.str} {made.names} {made.attributes} {coordinates}: {problem}")
        else:
            path.unlink()
    print(f"{number} files, {wrong} of which differ (seed {seed})")
    if not wrong:
        directory.rmdir()
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
