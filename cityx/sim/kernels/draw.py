"""What a camera sees: triangles drawn from near to far, and whatever is hidden left out whole.

The trees of the ray caster (`cityx.geometry.bvh`) are gone through from the eye on. A node of which
no middle of a pixel is within the outline on the picture, or that lies behind what is drawn there
already, is left out with all that it holds. A pixel so sees what a ray through its middle meets;
there are no coarser forms for what is far away.

References
----------
N. Greene, M. Kass, G. Miller, "Hierarchical Z-buffer visibility", SIGGRAPH 1993.
M. Olano, T. Greer, "Triangle scan conversion using 2D homogeneous coordinates", HWWS 1997.
"""

from __future__ import annotations

from math import ceil, floor
from typing import Any

import numpy as np

from cityx.geometry.bvh import DEEP, SCALE
from cityx.geometry.compiled import borrowing, compiled

BLOCK = 8  # pixels of a side of the squares whose farthest depth is kept
FEW = 24  # pixels up to which each is looked at, instead of the squares
SLACK = 1.000001  # relative, above what the single precision of kept depths rounds away


@compiled
def outline(m: Any, cx: float, cy: float, cz: float, hx: float, hy: float, hz: float,
            width: int, height: int, near: float) -> Any:  # fmt: skip
    """Return the pixels that a box may cover: its least depth, first and last column and row.

    The depth is negative where it covers none.

    Parameters
    ----------
    m
        (3, 4): columns and rows times depth, and depth, of a point in the frame of the box.
    cx, cy, cz, hx, hy, hz
        Its middle, and half its size.
    """
    cw = m[2, 0] * cx + m[2, 1] * cy + m[2, 2] * cz + m[2, 3]
    ew0, ew1, ew2 = m[2, 0] * hx, m[2, 1] * hy, m[2, 2] * hz
    deep = abs(ew0) + abs(ew1) + abs(ew2)
    if cw + deep < near:
        return -1.0, 0, 0, 0, 0
    cu = m[0, 0] * cx + m[0, 1] * cy + m[0, 2] * cz + m[0, 3]
    eu0, eu1, eu2 = m[0, 0] * hx, m[0, 1] * hy, m[0, 2] * hz
    cv = m[1, 0] * cx + m[1, 1] * cy + m[1, 2] * cz + m[1, 3]
    ev0, ev1, ev2 = m[1, 0] * hx, m[1, 1] * hy, m[1, 2] * hz
    least = cw - deep
    if least < near:  # it reaches behind the picture: outside one of its four sides, or not
        a, b = width - 0.5, height - 0.5
        if (
            cu + 0.5 * cw
            + abs(eu0 + 0.5 * ew0) + abs(eu1 + 0.5 * ew1) + abs(eu2 + 0.5 * ew2) < 0.0
            or a * cw - cu
            + abs(a * ew0 - eu0) + abs(a * ew1 - eu1) + abs(a * ew2 - eu2) < 0.0
            or cv + 0.5 * cw
            + abs(ev0 + 0.5 * ew0) + abs(ev1 + 0.5 * ew1) + abs(ev2 + 0.5 * ew2) < 0.0
            or b * cw - cv
            + abs(b * ew0 - ev0) + abs(b * ew1 - ev1) + abs(b * ew2 - ev2) < 0.0
        ):  # fmt: skip
            return -1.0, 0, 0, 0, 0
        return near, 0, width - 1, 0, height - 1
    u0, u1, v0, v1 = np.inf, -np.inf, np.inf, -np.inf
    for k in range(8):
        s0 = 1.0 if k & 1 else -1.0
        s1 = 1.0 if k & 2 else -1.0
        s2 = 1.0 if k & 4 else -1.0
        back = 1.0 / (cw + s0 * ew0 + s1 * ew1 + s2 * ew2)
        u = (cu + s0 * eu0 + s1 * eu1 + s2 * eu2) * back
        v = (cv + s0 * ev0 + s1 * ev1 + s2 * ev2) * back
        u0, u1 = min(u0, u), max(u1, u)
        v0, v1 = min(v0, v), max(v1, v)
    if u1 < 0.0 or v1 < 0.0 or u0 > width - 1 or v0 > height - 1:
        return -1.0, 0, 0, 0, 0
    i0, i1 = ceil(max(u0, 0.0)), floor(min(u1, width - 1.0))
    j0, j1 = ceil(max(v0, 0.0)), floor(min(v1, height - 1.0))
    if i0 > i1 or j0 > j1:
        return -1.0, 0, 0, 0, 0
    return least, i0, i1, j0, j1


@borrowing
def hidden(depth: float, i0: int, i1: int, j0: int, j1: int, close: Any, square: Any,
           stale: Any) -> bool:  # fmt: skip
    """Tell whether all of a box lies behind what is drawn; `close` holds 1 / depth."""
    back = SLACK / depth
    if (i1 - i0 + 1) * (j1 - j0 + 1) <= FEW:
        for j in range(j0, j1 + 1):
            for i in range(i0, i1 + 1):
                if close[j, i] < back:
                    return False
        return True
    height, width = close.shape
    for q in range(j0 // BLOCK, j1 // BLOCK + 1):
        for p in range(i0 // BLOCK, i1 // BLOCK + 1):
            if stale[q, p]:
                stale[q, p] = 0
                found = close[q * BLOCK, p * BLOCK]
                for j in range(q * BLOCK, min(q * BLOCK + BLOCK, height)):
                    for i in range(p * BLOCK, min(p * BLOCK + BLOCK, width)):
                        found = min(found, close[j, i])
                square[q, p] = found
            if square[q, p] < back:
                return False
    return True


@borrowing
def triangle(m: Any, corner: Any, row: int, number: int, near: float, close: Any, thing: Any,
             face: Any, stale: Any) -> None:  # fmt: skip
    """Draw one triangle; of two at the same depth the one of the lower thing is seen."""
    height, width = close.shape
    x, y, z = corner[row, 0, 0], corner[row, 0, 1], corner[row, 0, 2]
    au = m[0, 0] * x + m[0, 1] * y + m[0, 2] * z + m[0, 3]
    av = m[1, 0] * x + m[1, 1] * y + m[1, 2] * z + m[1, 3]
    aw = m[2, 0] * x + m[2, 1] * y + m[2, 2] * z + m[2, 3]
    x, y, z = corner[row, 1, 0], corner[row, 1, 1], corner[row, 1, 2]
    bu = m[0, 0] * x + m[0, 1] * y + m[0, 2] * z + m[0, 3]
    bv = m[1, 0] * x + m[1, 1] * y + m[1, 2] * z + m[1, 3]
    bw = m[2, 0] * x + m[2, 1] * y + m[2, 2] * z + m[2, 3]
    x, y, z = corner[row, 2, 0], corner[row, 2, 1], corner[row, 2, 2]
    cu = m[0, 0] * x + m[0, 1] * y + m[0, 2] * z + m[0, 3]
    cv = m[1, 0] * x + m[1, 1] * y + m[1, 2] * z + m[1, 3]
    cw = m[2, 0] * x + m[2, 1] * y + m[2, 2] * z + m[2, 3]
    if max(aw, bw, cw) < near:
        return
    i0, i1, j0, j1 = 0.0, width - 1.0, 0.0, height - 1.0
    if min(aw, bw, cw) >= near:
        ia, ib, ic = 1.0 / aw, 1.0 / bw, 1.0 / cw
        i0 = max(i0, ceil(min(au * ia, bu * ib, cu * ic)))
        i1 = min(i1, floor(max(au * ia, bu * ib, cu * ic)))
        j0 = max(j0, ceil(min(av * ia, bv * ib, cv * ic)))
        j1 = min(j1, floor(max(av * ia, bv * ib, cv * ic)))
        if i0 > i1 or j0 > j1:
            return
    # Edges as planes through the eye: the side of a ray (i, j, 1) is the sign of a i + b j + c.
    # Two triangles with an edge have the same three numbers, negated, and so no gap between them.
    ea0, eb0, ec0 = bv * cw - bw * cv, bw * cu - bu * cw, bu * cv - bv * cu
    ea1, eb1, ec1 = cv * aw - cw * av, cw * au - cu * aw, cu * av - cv * au
    ea2, eb2, ec2 = av * bw - aw * bv, aw * bu - au * bw, au * bv - av * bu
    volume = au * ea0 + av * eb0 + aw * ec0
    if volume == 0.0:
        return
    sign = 1.0 if volume > 0.0 else -1.0
    ea0, eb0, ec0 = sign * ea0, sign * eb0, sign * ec0
    ea1, eb1, ec1 = sign * ea1, sign * eb1, sign * ec1
    ea2, eb2, ec2 = sign * ea2, sign * eb2, sign * ec2
    whole = 1.0 / abs(volume)
    za, zb, zc = (ea0 + ea1 + ea2) * whole, (eb0 + eb1 + eb2) * whole, (ec0 + ec1 + ec2) * whole
    most = np.float32(1.0 / near)
    ra0 = 1.0 / ea0 if ea0 != 0.0 else 0.0
    ra1 = 1.0 / ea1 if ea1 != 0.0 else 0.0
    ra2 = 1.0 / ea2 if ea2 != 0.0 else 0.0
    for j in range(int(j0), int(j1) + 1):
        low, high = i0, i1
        c0, c1, c2 = eb0 * j + ec0, eb1 * j + ec1, eb2 * j + ec2
        if ea0 > 0.0:
            low = max(low, -c0 * ra0)
        elif ea0 < 0.0:
            high = min(high, -c0 * ra0)
        elif c0 < 0.0:
            continue
        if ea1 > 0.0:
            low = max(low, -c1 * ra1)
        elif ea1 < 0.0:
            high = min(high, -c1 * ra1)
        elif c1 < 0.0:
            continue
        if ea2 > 0.0:
            low = max(low, -c2 * ra2)
        elif ea2 < 0.0:
            high = min(high, -c2 * ra2)
        elif c2 < 0.0:
            continue
        if low > high:
            continue
        first, last = ceil(low), floor(high)
        if first > last:
            continue
        base = zb * j + zc
        drawn = False
        for i in range(first, last + 1):
            at = np.float32(za * i + base)
            if at > most:
                continue
            held = close[j, i]
            if at > held or (at == held and number < thing[j, i]):
                close[j, i] = at
                thing[j, i] = number
                face[j, i] = row
                drawn = True
        if drawn:
            q = j // BLOCK
            for p in range(first // BLOCK, last // BLOCK + 1):
                stale[q, p] = 1


@borrowing
def mesh(node: int, m: Any, box: Any, child: Any, corner: Any, number: int, near: float,
         close: Any, thing: Any, face: Any, square: Any, stale: Any, stack: Any, span: Any,
         depth: Any) -> None:  # fmt: skip
    """Draw what is under a node of a mesh, the nearer of two children first."""
    height, width = close.shape
    stack[0] = node
    depth[0] = -1.0
    waiting = 1
    while waiting:
        waiting -= 1
        node = stack[waiting]
        if depth[waiting] > 0.0 and hidden(
            depth[waiting], span[waiting, 0], span[waiting, 1], span[waiting, 2],
            span[waiting, 3], close, square, stale,
        ):  # fmt: skip
            continue
        if node < 0:
            code = -1 - node
            for row in range(code // SCALE, code // SCALE + code % SCALE):
                triangle(m, corner, row, number, near, close, thing, face, stale)
            continue
        first_depth = -1.0
        for side in range(2):
            at = 6 * side
            hx = 0.5 * (np.float64(box[node, at + 3]) - box[node, at])
            hy = 0.5 * (np.float64(box[node, at + 4]) - box[node, at + 1])
            hz = 0.5 * (np.float64(box[node, at + 5]) - box[node, at + 2])
            least, i0, i1, j0, j1 = outline(
                m, box[node, at] + hx, box[node, at + 1] + hy, box[node, at + 2] + hz,
                hx, hy, hz, width, height, near,
            )  # fmt: skip
            if least < 0.0:
                continue
            own = waiting
            if first_depth >= 0.0 and least > first_depth:  # the farther one waits below
                own = waiting - 1
                stack[waiting], depth[waiting] = stack[own], depth[own]
                for k in range(4):
                    span[waiting, k] = span[own, k]
            stack[own], depth[own] = child[node, side], least
            span[own, 0], span[own, 1], span[own, 2], span[own, 3] = i0, i1, j0, j1
            first_depth = least
            waiting += 1


@borrowing
def onto(view: Any, way: Any, m: Any) -> None:
    """Write the view of a camera from the frame of a thing."""
    for r in range(3):
        for c in range(3):
            m[r, c] = view[r, 0] * way[0, c] + view[r, 1] * way[1, c] + view[r, 2] * way[2, c]
        m[r, 3] = (view[r, 0] * way[0, 3] + view[r, 1] * way[1, 3] + view[r, 2] * way[2, 3]
                   + view[r, 3])  # fmt: skip


@compiled
def draw(
    box: Any, child: Any, corner: Any, way: Any, cluster_thing: Any, cluster_node: Any,
    top_root: int, top_box: Any, top_child: Any, top_order: Any,
    mover_node: Any, mover_box: Any, mover_way: Any, skipped: int,
    view: Any, near: float, close: Any, thing: Any, face: Any,
) -> None:  # fmt: skip
    """Draw what a camera sees.

    Parameters
    ----------
    box, child, corner
        Trees of meshes, see `cityx.geometry.bvh`.
    way
        (n, 3, 4) from the frames of what stands still to that of the scene.
    cluster_thing, cluster_node
        (c,) parts of things: which, and what node of its mesh.
    top_root, top_box, top_child, top_order
        Tree over the clusters.
    mover_node, mover_box, mover_way
        (k,) root, (k, 6) bounds and (k, 3, 4) transform of the meshes of what moves.
    skipped
        One of them that is not seen, its own; -1 for none.
    view
        (3, 4): columns and rows times depth, and depth, of a point of the scene.
    near
        Depth from which on something is seen.
    close, thing, face
        (h, w) float32, int32 and int32, to be written: 1 / depth, which thing, movers after those
        that stand still, and which triangle; 0, -1 and -1 where there is nothing.
    """
    height, width = close.shape
    close[:] = 0.0
    thing[:] = -1
    face[:] = -1
    square = np.zeros(((height + BLOCK - 1) // BLOCK, (width + BLOCK - 1) // BLOCK), np.float32)
    stale = np.zeros(square.shape, np.uint8)
    stack, depth, span = np.empty(2 * DEEP, np.int64), np.empty(2 * DEEP), np.empty(
        (2 * DEEP, 4), np.int64)  # fmt: skip
    high, high_depth, high_span = np.empty(2 * DEEP, np.int64), np.empty(2 * DEEP), np.empty(
        (2 * DEEP, 4), np.int64)  # fmt: skip
    m = np.empty((3, 4))
    high[0], high_depth[0] = top_root, -1.0
    waiting = 1
    while waiting:
        waiting -= 1
        node = high[waiting]
        if high_depth[waiting] > 0.0 and hidden(
            high_depth[waiting], high_span[waiting, 0], high_span[waiting, 1],
            high_span[waiting, 2], high_span[waiting, 3], close, square, stale,
        ):  # fmt: skip
            continue
        if node < 0:
            code = -1 - node
            for member in range(code // SCALE, code // SCALE + code % SCALE):
                cluster = top_order[member]
                number = cluster_thing[cluster]
                onto(view, way[number], m)
                mesh(cluster_node[cluster], m, box, child, corner, number, near, close, thing,
                     face, square, stale, stack, span, depth)  # fmt: skip
            continue
        first_depth = -1.0
        for side in range(2):
            at = 6 * side
            hx = 0.5 * (np.float64(top_box[node, at + 3]) - top_box[node, at])
            hy = 0.5 * (np.float64(top_box[node, at + 4]) - top_box[node, at + 1])
            hz = 0.5 * (np.float64(top_box[node, at + 5]) - top_box[node, at + 2])
            least, i0, i1, j0, j1 = outline(
                view, top_box[node, at] + hx, top_box[node, at + 1] + hy,
                top_box[node, at + 2] + hz, hx, hy, hz, width, height, near,
            )  # fmt: skip
            if least < 0.0:
                continue
            own = waiting
            if first_depth >= 0.0 and least > first_depth:
                own = waiting - 1
                high[waiting], high_depth[waiting] = high[own], high_depth[own]
                for k in range(4):
                    high_span[waiting, k] = high_span[own, k]
            high[own], high_depth[own] = top_child[node, side], least
            high_span[own, 0], high_span[own, 1] = i0, i1
            high_span[own, 2], high_span[own, 3] = j0, j1
            first_depth = least
            waiting += 1
    still = len(way)
    for k in range(len(mover_node)):
        if k == skipped:
            continue
        onto(view, mover_way[k], m)
        b = mover_box[k]
        hx, hy, hz = 0.5 * (b[3] - b[0]), 0.5 * (b[4] - b[1]), 0.5 * (b[5] - b[2])
        least, i0, i1, j0, j1 = outline(m, b[0] + hx, b[1] + hy, b[2] + hz, hx, hy, hz, width,
                                        height, near)  # fmt: skip
        if least >= 0.0 and not hidden(least, i0, i1, j0, j1, close, square, stale):
            mesh(mover_node[k], m, box, child, corner, still + k, near, close, thing, face,
                 square, stale, stack, span, depth)  # fmt: skip
