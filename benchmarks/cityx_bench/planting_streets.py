"""Planting in streets and parks: defects of bridges, junctions and rows of things."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely

from cityx.checks.predicates.words import LANDS
from cityx.city import City
from cityx.city.ground import LABEL, ON_ROADWAY
from cityx_bench.planting import (
    Plant,
    Planted,
    any_building,
    drawn,
    drawn_row,
    taken,
    with_faces,
    with_rows,
    with_shells,
)

DECK = 12.0  # metres to each side of a bridge's middle that its deck reaches at most


def no_park(city: City, key: int) -> Planted | None:
    """Leave the parks out."""
    del key
    park = city.layout.areas["kind"].isin(LANDS["park"]).to_numpy()
    if not park.any():
        return None
    areas = city.layout.areas[~park].reset_index(drop=True)
    return Planted(replace(city, layout=replace(city.layout, areas=areas)), (), ("n(park) >= 1",))


def _bridge(city: City, key: int) -> Any:
    """Draw a road that is a bridge; its id and line."""
    roads = city.layout.roads
    ids = roads["id"].to_numpy(np.uint64)[roads["bridge"].to_numpy(bool)]
    owner = drawn(ids, key)
    if owner is None:
        return None
    return owner, roads.geometry.to_numpy()[(roads["id"] == owner).to_numpy()][0]


def no_deck(city: City, key: int) -> Planted | None:
    """Take the deck of a bridge away."""
    found = _bridge(city, key)
    decks = city.scene.meshes.get("decks")
    if found is None or decks is None:
        return None
    corner = decks.vertices[decks.faces[:, :3], :2].mean(axis=1)
    kept = shapely.distance(shapely.points(corner), found[1]) > DECK
    changed = replace(city, scene=city.scene.with_mesh("decks", with_faces(decks, kept)))
    return Planted(changed)


def no_bridge(city: City, key: int) -> Planted | None:
    """Leave out a bridge of those asked over a river."""
    from cityx.checks.predicates import measure

    found = _bridge(city, key)
    if found is None:
        return None
    count = measure("n(bridge) >= 0", city).value
    assert isinstance(count, float)
    roads = city.layout.roads
    near = shapely.distance(roads.geometry.to_numpy(), found[1]) < 1.0
    kept = ~(near & roads["bridge"].to_numpy(bool))
    layout = replace(city.layout, roads=roads[kept].reset_index(drop=True))
    return Planted(replace(city, layout=layout, network=None, lanes=None), (),
                   (f"n(bridge) == {count:g}",))  # fmt: skip


def _junction(city: City, key: int) -> int | None:
    """Draw a junction on the ground that cars drive over; its node."""
    graph, network, ground = city.lanes, city.network, city.ground
    if graph is None or network is None or ground is None or not len(graph.connection):
        return None
    lane = graph.connection[:, 0]
    ends = network.edge_nodes[graph.edge[lane]]
    node = np.unique(np.where(graph.direction[lane] > 0, ends[:, 1], ends[:, 0]))
    xy = network.node_position[node]
    low, high = np.array(city.layout.extent[:2]), np.array(city.layout.extent[2:])
    inside = ((xy > low + 15) & (xy < high - 15)).all(axis=1)
    kept = inside & (network.node_degree[node] >= 3) & ground.on(xy, "junction", *ON_ROADWAY)
    found = drawn(node[kept], key)
    return None if found is None else int(found)


def _place_of(city: City, node: int) -> tuple[str, ...]:
    assert city.network is not None
    x, y = city.network.node_position[node].tolist()
    return (f"({x:.1f}, {y:.1f})",)


def covered_junction(city: City, key: int) -> Planted | None:
    """Pave a junction as a walk, so that nobody may drive over it."""
    node = _junction(city, key)
    if node is None:
        return None
    assert city.network is not None
    assert city.ground is not None
    ground = city.ground
    corners = ground.vertices[ground.triangles]
    at = city.network.node_position[node]
    near = np.hypot(*(corners - at).transpose(2, 0, 1)).min(axis=1) < 8.0
    faces = np.zeros(len(ground.face_label), bool)
    faces[ground.triangle_face[near]] = True
    faces &= ground.labelled("junction", *ON_ROADWAY)
    label = np.where(faces, LABEL["sidewalk"], ground.face_label).astype(ground.face_label.dtype)
    changed = replace(city, ground=replace(ground, face_label=label))
    return Planted(changed, _place_of(city, node))


def closed_junction(city: City, key: int) -> Planted | None:
    """Remove every lane over a junction."""
    node = _junction(city, key)
    graph, network = city.lanes, city.network
    if node is None or graph is None or network is None:
        return None
    lane = graph.connection[:, 0]
    ends = network.edge_nodes[graph.edge[lane]]
    kept = np.where(graph.direction[lane] > 0, ends[:, 1], ends[:, 0]) != node
    length = np.diff(graph.curve_start)
    changed = replace(
        graph,
        connection=graph.connection[kept],
        movement=graph.movement[kept],
        curve_start=np.concatenate([[0], np.cumsum(length[kept])]).astype(np.int64),
        curve=graph.curve[np.repeat(kept, length)],
    )
    return Planted(replace(city, lanes=changed), _place_of(city, node))


def repainted(city: City, key: int) -> Planted | None:
    """Shade a building by two parts in a hundred: no defect."""
    owner = any_building(city, key)
    if owner is None:
        return None
    batch = city.scene.meshes["buildings"]
    mine = owner == np.repeat(batch.object_id, np.diff(batch.face_start))
    tint = np.where(mine[:, None], 0.98 * batch.tint, batch.tint).astype(np.float32)
    return Planted(with_shells(city, replace(batch, tint=tint)))


def turned_tree(city: City, key: int) -> Planted | None:
    """Turn a tree about its trunk and let it be 3 % smaller: no defect."""
    found = drawn_row(city, ("trees",), key)
    if found is None:
        return None
    rows = city.scene.instances["trees"]
    scale, rotation = rows.scale.copy(), rows.rotation.copy()
    scale[found[1]] *= 0.97
    rotation[found[1], 2] += 0.5
    return Planted(with_rows(city, "trees", replace(rows, scale=scale, rotation=rotation)))


def one_less(layers: tuple[str, ...]) -> Plant:
    """Return what takes one thing of many away, which nobody asked for: no defect."""

    def plant(city: City, key: int) -> Planted | None:
        found = drawn_row(city, layers, key)
        if found is None:
            return None
        rows = city.scene.instances[found[0]]
        return Planted(with_rows(city, found[0], taken(rows, np.arange(rows.count) != found[1])))

    return plant
