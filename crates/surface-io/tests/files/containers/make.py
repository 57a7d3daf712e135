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
