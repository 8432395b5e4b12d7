"""Checks the files of VTK that `storegga export` wrote against their log: check_vtk.py LOG.mcap FOLDER.

Both are read by libraries that share no code with the program (PyPI's `mcap`, `mcap-protobuf-support` and `pyvista`): times, and every
position, velocity, pressure and phase of every frame must be the same to the bit.
"""

import sys

import numpy
import pyvista
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

log, folder = sys.argv[1:]
types = {1: "u1", 5: "<u4", 7: "<f4"}
clouds = []
with open(log, "rb") as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    for _, _, message, cloud in reader.iter_decoded_messages(topics=["/particles"]):
        row = numpy.dtype(
            {
                "names": [field.name for field in cloud.fields],
                "formats": [types[field.type] for field in cloud.fields],
                "offsets": [field.offset for field in cloud.fields],
                "itemsize": cloud.point_stride,
            }
        )
        clouds.append((message.log_time / 1e9, numpy.frombuffer(cloud.data, row)))

files = pyvista.get_reader(f"{folder}/particles.pvd")
assert len(clouds) > 1 and numpy.allclose(files.time_values, [time for time, _ in clouds], rtol=0, atol=1e-9), files
for time, rows in clouds:
    files.set_active_time_value(min(files.time_values, key=lambda other: abs(other - time)))
    mesh = files.read()[0]
    assert mesh.n_points == mesh.n_cells == len(rows) > 0, mesh
    assert abs(mesh.field_data["TimeValue"][0] - time) < 1e-9
    assert "pressure: Pa" in mesh.field_data["units"][0]
    for k, axis in enumerate("xyz"):
        assert (mesh.points[:, k] == rows[axis]).all(), axis
        assert (mesh["velocity"][:, k] == rows[f"v{axis}"]).all(), axis
    for name in ("pressure", "density", "phase", "id"):
        assert (mesh[name] == rows[name]).all(), name
print(f"{len(clouds)} frames of {len(rows)} particles are the same in {folder} and {log}")
