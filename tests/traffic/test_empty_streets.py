"""Where nobody drives there are no tracks, and no error."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from cityx.traffic.simulation import _read_poses


def test_a_recording_in_which_nobody_was_ever_there_has_no_poses(tmp_path):
    # SUMO writes no columns of vehicles then.
    pq.write_table(pa.table({"timestep_time": np.arange(3.0)}), tmp_path / "poses.parquet")
    poses = _read_poses(tmp_path / "poses.parquet", 0.0)
    assert len(poses.name) == len(poses.time) == len(poses.mover) == 0
