"""Writes the small files beside it with h5py 3.16, netCDF4 1.7 and tifffile."""

import h5py
import netCDF4
import numpy as np
import tifffile

Z = np.array([[1.3, 2.9, 2.2, 4.1], [0.7, 5.2, 3.3, 1.8], [2.4, 0.2, 6.1, 3.7]])


def holed(mark):
    z = Z.astype("f4")
    z[1, 2] = np.float32(mark)
    return z


# A double as the mark of undefined points beside float32.
with h5py.File("double-fill.h5", "w", libver="latest") as f:
    d = f.create_dataset("z", data=holed(-9999.9))
    d.attrs["_FillValue"] = np.float64(-9999.9)
    d.dims[0].label, d.dims[1].label = "y", "x"
with netCDF4.Dataset("double-missing.nc", "w", format="NETCDF3_CLASSIC") as f:
    f.createDimension("y", 3), f.createDimension("x", 4)
    v = f.createVariable("heights", "f4", ("y", "x"))
    v.set_auto_maskandscale(False)
    v.setncattr("missing_value", np.float64(-3.4e38))
    v[:] = holed(-3.4e38)
# 15 digits of the lowest float32, and a mark that no tag declares.
tifffile.imwrite("nodata-15-digits.tif", holed(np.finfo("f4").min),
                 extratags=[(42113, 2, 0, "-3.40282346638529e+38", True)])
tifffile.imwrite("undeclared.tif", holed(-9999.9))

# Names of dimensions, and coordinates along them.


def nc(name, dimensions, z=Z, kind="NETCDF4", **attributes):
    """A variable z over two dimensions (name, coordinates, unit)."""
    with netCDF4.Dataset(name, "w", format=kind) as f:
        for name, values, unit in dimensions:
            f.createDimension(name, len(values))
            v = f.createVariable(name, "f4", (name,))
            v[:] = values
            if unit:
                v.units = unit
        v = f.createVariable("z", z.dtype, [d[0] for d in dimensions])
        v.set_auto_maskandscale(False)
        v.units = "nm"
        v.setncatts(attributes)
        v[:] = z


up, down, uneven = [0, 2, 4], [4, 2, 0], [0, 2, 5]
nc("descending.nc", [("lat", down, "meters"), ("lon", [0, 1, 2, 3], "m")])
nc("descending-3.nc", [("lat", down, "meters"), ("lon", [0, 1, 2, 3], "m")], kind="NETCDF3_CLASSIC")
nc("xy.nc", [("x", [0, 1, 2, 3], "um"), ("y", up, "um")], z=Z.T.copy())
nc("degrees.nc", [("lat", [50, 50.1, 50.2], "degrees_north"), ("lon", [7, 7.1, 7.2, 7.3], "degrees_east")])
nc("plain.nc", [("y", up, ""), ("x", [0, 1, 2, 3], "")])
nc("uneven.nc", [("y", uneven, "m"), ("x", [0, 1, 2, 3], "m")])
nc("uneven-3.nc", [("y", uneven, "m"), ("x", [0, 1, 2, 3], "m")], kind="NETCDF3_CLASSIC")
nc("time.nc", [("time", up, "s"), ("x", [0, 1, 2, 3], "m")])
nc("unsigned-3.nc", [("y", up, "um"), ("x", [0, 1, 2, 3], "um")], kind="NETCDF3_CLASSIC",
   z=np.array([[100, 200, 300, 400], [-25536, -15536, -5536, -1], [32767, -32768, 7, 9]], "i2"),
   _Unsigned="true", scale_factor=0.1, missing_value=np.int16(-1))
# Numbers outside of a range are undefined: the ends of the range are heights, as they are stored.
counts = np.array([[1, 2, 3, 4], [-1, 6, 999, 8], [9, 10, 11, 100]], "i2")
flat = [("y", up, "um"), ("x", [0, 1, 2, 3], "um")]
nc("valid-range.nc", flat, z=counts, valid_range=np.array([1, 100], "i2"), scale_factor=0.5)
nc("valid-ends-3.nc", flat, kind="NETCDF3_CLASSIC", z=counts, valid_min=np.int16(1), valid_max=np.int16(100), scale_factor=0.5)
nc("unsigned-word.nc", flat, z=counts, _Unsigned="yes", scale_factor=0.5)
nc("unsigned-word-3.nc", flat, kind="NETCDF3_CLASSIC", z=counts, _Unsigned="yes", scale_factor=0.5)
nc("valid-three.nc", flat, z=counts, valid_range=np.array([1, 2, 3], "i2"), scale_factor=0.5)
nc("valid-three-3.nc", flat, kind="NETCDF3_CLASSIC", z=counts, valid_range=np.array([1, 2, 3], "i2"), scale_factor=0.5)
for name, values in ("scales.h5", Z), ("scales-square.h5", Z[:, :3]):
    with h5py.File(name, "w") as f:
        g = f.create_group("a")
        d = g.create_dataset("z", data=values)
        d.attrs["units"] = "nm"
        for i, name in enumerate(["y", "x"]):
            s = f.create_dataset(name, data=2e-6 * np.arange(values.shape[i]), chunks=(2,), compression="gzip")
            s.attrs["units"] = "m"
            s.make_scale()
            d.dims[i].attach_scale(s)
with netCDF4.Dataset("line.nc", "w", format="NETCDF3_CLASSIC") as f:
    f.createDimension("x", 3)
    f.createVariable("profile", "f8", ("x",))[:] = [1, 2, 3]

# TIFF.
items = '<GDALMetadata>\n  <Item name="{}" sample="0" role="{}">{}</Item>\n</GDALMetadata>'


def ascii(tag, text):
    return (tag, 2, 0, text, True)


projected = [(33550, 12, 3, (10.0, 5.0, 0.0), True), (34735, 3, 12, (1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, 9001), True)]
tifffile.imwrite("metres.tif", Z.astype("f4"),
                 extratags=[*projected, ascii(42112, items.format("UNITTYPE", "unittype", "metre"))])
tifffile.imwrite("wrong-scale.tif", Z.astype("f4"), extratags=[ascii(42112, items.format("SCALE", "scale", "two"))])
tifffile.imwrite("no-number.tif", Z.astype("f4"), extratags=[ascii(42113, "none")])
with tifffile.TiffWriter("overview.tif") as f:
    f.write(Z.astype("f4"))
    f.write(Z[::2, ::2].astype("f4"), subfiletype=1)
valid = np.ones(Z.shape, bool)
valid[1, 2] = False
for name, options in ("mask-tiles.tif", {"tile": (16, 16), "compression": "zlib"}), ("mask-packed.tif", {"compression": "packbits"}):
    with tifffile.TiffWriter(name) as f:
        f.write(Z.astype("f4"))
        f.write(valid, subfiletype=4, photometric="mask", **options)

# What is no map.
with h5py.File("volume.h5", "w") as f:
    f["stack"] = np.zeros((2, 3, 4))
    f["line"] = np.zeros(3)
