"""Heights of roads: grades, structures, embankments, retaining walls, stairs."""
