"""Bounding volume hierarchy over triangles and instances, and rays through it, compiled by numba.

Import it lazily: numba alone takes half a second. Kernels release Python's lock, so that threads
share the rays, and are cached on disk (in the user's cache folder where the package is read-only).
They add and multiply in float64 and never fuse the two, which the test of edges relies on.

Nodes are rows of two children: ``box`` (n, 12) float32 holds the lower and upper corner of both,
``child`` (n, 2) int64 the row of a node, or for a leaf ``-1 - (first * 8 + count)`` of its members.

References
----------
I. Wald, "On fast construction of SAH-based bounding volume hierarchies", RT 2007.
S. Woop, C. Benthin, I. Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cityx.geometry.compiled import compiled

BINS = 16
DEEP = 96  # entries of a stack, and so the height of a tree
HALVED = 48  # deep from which members are cut to equal halves, which ends within 48 more
FACES = 4  # triangles of a leaf, at most
ONE = 1  # instances of a leaf: to enter one in vain costs more than to look at its box
SCALE = 8  # of the code of a leaf; above FACES
EMPTY = -1  # code of a leaf without members
OUTWARD = 4e-7  # relative growth of a box, above what float32 rounds away
TINY = 1e-300  # instead of a direction of 0: its inverse is still finite


@compiled
def build(
    work: Any, order: Any, begin: int, end: int, most: int, box: Any, child: Any, used: int
) -> Any:  # fmt: skip
    """Build the tree over members ``begin`` to ``end``.

    Parameters
    ----------
    work
        (n, 6) float32, lower and upper corners; put in the order of the leaves.
    order
        (n,) number of each member; put in the order of the leaves.
    begin, end
        Range of members.
    most
        Members of a leaf, at most.
    box, child
        Nodes; rows from `used` on are written.
    used
        Rows in use.

    Returns
    -------
    root, used
        Code of the root, which may be a leaf, and rows in use.
    """
    if end - begin <= most:
        return -1 - (begin * SCALE + (end - begin)), used
    todo = np.empty((DEEP, 4), np.int64)
    count = np.empty((3, BINS), np.int64)
    low, high = np.empty((3, BINS, 3), np.float32), np.empty((3, BINS, 3), np.float32)
    area, number = np.empty(BINS), np.empty(BINS, np.int64)
    middle_low, middle_high = np.empty(3, np.float32), np.empty(3, np.float32)
    first_low, first_high = np.empty(3, np.float32), np.empty(3, np.float32)
    factor = np.empty(3, np.float32)
    root = used
    used += 1
    todo[0, 0], todo[0, 1], todo[0, 2], todo[0, 3] = begin, end, root, 0
    waiting = 1
    while waiting:
        waiting -= 1
        first, last, node = todo[waiting, 0], todo[waiting, 1], todo[waiting, 2]
        depth = todo[waiting, 3]
        for a in range(3):
            middle_low[a], middle_high[a] = np.inf, -np.inf
        for i in range(first, last):
            for a in range(3):
                middle = work[i, a] + work[i, a + 3]
                middle_low[a] = min(middle_low[a], middle)
                middle_high[a] = max(middle_high[a], middle)
        for a in range(3):
            extent = middle_high[a] - middle_low[a]
            factor[a] = BINS * np.float32(0.9999) / extent if extent > 0 else 0.0
        count[:] = 0
        low[:] = np.inf
        high[:] = -np.inf
        for i in range(first, last):
            for a in range(3):
                b = int((work[i, a] + work[i, a + 3] - middle_low[a]) * factor[a])
                count[a, b] += 1
                for k in range(3):
                    low[a, b, k] = min(low[a, b, k], work[i, k])
                    high[a, b, k] = max(high[a, b, k], work[i, k + 3])
        best, axis, cut = np.inf, -1, 0
        for a in range(3):
            if factor[a] == 0:
                continue
            for k in range(3):
                first_low[k], first_high[k] = np.inf, -np.inf
            total = 0
            for b in range(BINS - 1):
                total += count[a, b]
                for k in range(3):
                    first_low[k] = min(first_low[k], low[a, b, k])
                    first_high[k] = max(first_high[k], high[a, b, k])
                number[b] = total
                area[b] = _half_area(first_low, first_high) * total if total else 0.0
            for k in range(3):
                first_low[k], first_high[k] = np.inf, -np.inf
            total = 0
            for b in range(BINS - 1, 0, -1):
                total += count[a, b]
                for k in range(3):
                    first_low[k] = min(first_low[k], low[a, b, k])
                    first_high[k] = max(first_high[k], high[a, b, k])
                if total and number[b - 1]:
                    cost = area[b - 1] + _half_area(first_low, first_high) * total
                    if cost < best:
                        best, axis, cut = cost, a, b
        split = first
        if axis >= 0 and depth < HALVED:
            i, j = first, last - 1
            while i <= j:
                b = int((work[i, axis] + work[i, axis + 3] - middle_low[axis]) * factor[axis])
                if b < cut:
                    i += 1
                else:
                    for k in range(6):
                        work[i, k], work[j, k] = work[j, k], work[i, k]
                    order[i], order[j] = order[j], order[i]
                    j -= 1
            split = i
        if split in (first, last):  # all middles are the same, or the tree is high
            split = (first + last) // 2
        for side in range(2):
            start = first if side == 0 else split
            stop = split if side == 0 else last
            for k in range(3):
                first_low[k], first_high[k] = np.inf, -np.inf
            for i in range(start, stop):
                for k in range(3):
                    first_low[k] = min(first_low[k], work[i, k])
                    first_high[k] = max(first_high[k], work[i, k + 3])
            for k in range(3):
                box[node, 6 * side + k] = first_low[k]
                box[node, 6 * side + 3 + k] = first_high[k]
            if stop - start <= most:
                child[node, side] = -1 - (start * SCALE + (stop - start))
            else:
                child[node, side] = used
                todo[waiting, 0], todo[waiting, 1] = start, stop
                todo[waiting, 2], todo[waiting, 3] = used, depth + 1
                used += 1
                waiting += 1
        if waiting > 1 and child[node, 0] >= 0 and child[node, 1] >= 0:
            # The larger half waits, so that the stack is never deeper than the tree is high.
            top, below = waiting - 1, waiting - 2
            if todo[top, 1] - todo[top, 0] > todo[below, 1] - todo[below, 0]:
                for k in range(4):
                    todo[top, k], todo[below, k] = todo[below, k], todo[top, k]
    return root, used


@compiled
def _half_area(low: Any, high: Any) -> Any:
    x, y, z = high[0] - low[0], high[1] - low[1], high[2] - low[2]
    return x * y + y * z + z * x


@compiled
def grow(box: Any) -> None:
    """Grow (n, 6) or (n, 12) boxes by what float32 rounds away, so that no ray slips past."""
    for row in range(len(box)):
        for corner in range(0, box.shape[1], 6):
            for a in range(3):
                low, high = box[row, corner + a], box[row, corner + a + 3]
                by = np.float32(OUTWARD) * (abs(low) + abs(high) + np.float32(1e-3))
                box[row, corner + a], box[row, corner + a + 3] = low - by, high + by


@compiled
def build_all(corners: Any, first: Any, box: Any, child: Any, root: Any, order: Any) -> int:
    """Build a tree for each of m meshes.

    Parameters
    ----------
    corners
        (t, 3, 3) float32, the triangles of all meshes; put in the order of the leaves.
    first
        (m + 1,) int64, first triangle of each mesh.
    box, child
        Nodes to be written, at least one row per triangle.
    root
        (m,) int64, code of each mesh's root, to be written.
    order
        (t,) int32, number of each triangle in its mesh; put in the order of the leaves.

    Returns
    -------
    used
        Rows of nodes in use.
    """
    total = len(corners)
    work = np.empty((total, 6), np.float32)
    for i in range(total):
        for k in range(3):
            a, b, c = corners[i, 0, k], corners[i, 1, k], corners[i, 2, k]
            work[i, k] = min(a, b, c)
            work[i, k + 3] = max(a, b, c)
    used = 0
    for mesh in range(len(first) - 1):
        begin, end = first[mesh], first[mesh + 1]
        for i in range(begin, end):
            order[i] = i - begin
        root[mesh], used = build(work, order, begin, end, FACES, box, child, used)
        if end > begin:
            held = corners[begin:end].copy()
            for i in range(begin, end):
                corners[i] = held[order[i]]
    return used


@compiled
def bounds(corners: Any, first: Any, found: Any) -> None:
    """Write the (m, 6) lower and upper corners of m meshes; of an empty one inf and -inf."""
    for mesh in range(len(first) - 1):
        for k in range(3):
            found[mesh, k], found[mesh, k + 3] = np.inf, -np.inf
        for i in range(first[mesh], first[mesh + 1]):
            for c in range(3):
                for k in range(3):
                    found[mesh, k] = min(found[mesh, k], corners[i, c, k])
                    found[mesh, k + 3] = max(found[mesh, k + 3], corners[i, c, k])


@compiled
def _entry(
    box: Any, row: int, at: int, x: float, y: float, z: float, ix: float, iy: float, iz: float,
    nx: int, ny: int, nz: int, best: float,
) -> Any:  # fmt: skip
    """Return where a ray enters one of the boxes of a row, infinity if it misses or is later.

    ``nx`` is 0 where the ray enters through the lower face across x, else 3; likewise the others.
    """
    near: Any = max(0.0, (np.float64(box[row, at + nx]) - x) * ix)
    far: Any = min(best, (np.float64(box[row, at + 3 - nx]) - x) * ix)
    near = max(near, (np.float64(box[row, at + 1 + ny]) - y) * iy)
    far = min(far, (np.float64(box[row, at + 4 - ny]) - y) * iy)
    near = max(near, (np.float64(box[row, at + 2 + nz]) - z) * iz)
    far = min(far, (np.float64(box[row, at + 5 - nz]) - z) * iz)
    return near if near <= far else np.inf


@compiled
def _inverse(value: float) -> Any:
    return 1.0 / (value if value != 0.0 else TINY)


@compiled
def trace(
    mesh_root: Any, box: Any, child: Any, corners: Any, number: Any, texture: Any, uv: Any,
    mask_start: Any, mask_size: Any, mask_bits: Any,
    top_root: int, top_box: Any, top_child: Any, order: Any, mesh: Any, inverse: Any,
    origins: Any, directions: Any, begin: int, end: int, shift: int,
    distance: Any, instance: Any, triangle: Any, u_out: Any, v_out: Any, back: Any,
) -> None:  # fmt: skip
    """Cast rays ``begin`` to ``end``; the outputs hold what was found before, or how far to look.

    Of hits at the same distance the one of the lowest instance and triangle wins, so that the order
    in which boxes are visited changes nothing.

    Parameters
    ----------
    mesh_root, box, child, corners, number
        Trees over the triangles of the meshes, from `build_all`.
    texture, uv
        (t,) int32, mask of each triangle or -1, and (t, 3, 2) float32, its corners on the mask.
    mask_start, mask_size, mask_bits
        Masks: their first bit, their rows and columns, and the bits, True where a ray is stopped.
    top_root, top_box, top_child, order
        Tree over the instances.
    mesh, inverse
        (n,) int32 and (n, 3, 4) float64, of each instance: its mesh, and the way from the frame of
        the scene to its own.
    origins, directions
        (r, 3) float64.
    begin, end
        Range of rays.
    shift
        Is added to the number of an instance.
    distance, instance, triangle, u_out, v_out, back
        Outputs, see `cityx.geometry.raycast.Hits`.
    """
    stack, stack_near = np.empty(DEEP, np.int64), np.empty(DEEP)
    deep, deep_near = np.empty(DEEP, np.int64), np.empty(DEEP)
    for ray in range(begin, end):
        best = distance[ray]
        best_instance, best_triangle = instance[ray], np.int64(triangle[ray])
        ox, oy, oz = origins[ray, 0], origins[ray, 1], origins[ray, 2]
        dx, dy, dz = directions[ray, 0], directions[ray, 1], directions[ray, 2]
        ix, iy, iz = _inverse(dx), _inverse(dy), _inverse(dz)
        nx, ny, nz = 3 * int(ix < 0.0), 3 * int(iy < 0.0), 3 * int(iz < 0.0)
        stack[0], stack_near[0] = top_root, 0.0
        waiting = 1
        while waiting:
            waiting -= 1
            node = stack[waiting]
            if stack_near[waiting] > best:
                continue
            while node >= 0:
                one = _entry(top_box, node, 0, ox, oy, oz, ix, iy, iz, nx, ny, nz, best)
                two = _entry(top_box, node, 6, ox, oy, oz, ix, iy, iz, nx, ny, nz, best)
                if one == np.inf and two == np.inf:
                    node = EMPTY
                elif two == np.inf:
                    node = top_child[node, 0]
                elif one == np.inf:
                    node = top_child[node, 1]
                else:
                    later = 1 if one <= two else 0
                    stack[waiting] = top_child[node, later]
                    stack_near[waiting] = max(one, two)
                    waiting += 1
                    node = top_child[node, 1 - later]
            code = -1 - node
            for member in range(code // SCALE, code // SCALE + code % SCALE):
                thing = order[member]
                way = inverse[thing]
                px = way[0, 0] * ox + way[0, 1] * oy + way[0, 2] * oz + way[0, 3]
                py = way[1, 0] * ox + way[1, 1] * oy + way[1, 2] * oz + way[1, 3]
                pz = way[2, 0] * ox + way[2, 1] * oy + way[2, 2] * oz + way[2, 3]
                qx = way[0, 0] * dx + way[0, 1] * dy + way[0, 2] * dz
                qy = way[1, 0] * dx + way[1, 1] * dy + way[1, 2] * dz
                qz = way[2, 0] * dx + way[2, 1] * dy + way[2, 2] * dz
                jx, jy, jz = _inverse(qx), _inverse(qy), _inverse(qz)
                mx, my, mz = 3 * int(jx < 0.0), 3 * int(jy < 0.0), 3 * int(jz < 0.0)
                # Axes so that the ray runs along the last, in its positive sense.
                if abs(qx) >= abs(qy) and abs(qx) >= abs(qz):
                    kx, ky, kz = 1, 2, 0
                    p0, p1, p2, sx, sy, sz = py, pz, px, qy * jx, qz * jx, jx
                elif abs(qy) >= abs(qz):
                    kx, ky, kz = 2, 0, 1
                    p0, p1, p2, sx, sy, sz = pz, px, py, qz * jy, qx * jy, jy
                else:
                    kx, ky, kz = 0, 1, 2
                    p0, p1, p2, sx, sy, sz = px, py, pz, qx * jz, qy * jz, jz
                if sz < 0.0:
                    kx, ky, p0, p1, sx, sy = ky, kx, p1, p0, sy, sx
                deep[0], deep_near[0] = mesh_root[mesh[thing]], 0.0
                below = 1
                while below:
                    below -= 1
                    node = deep[below]
                    if deep_near[below] > best:
                        continue
                    while node >= 0:
                        one = _entry(box, node, 0, px, py, pz, jx, jy, jz, mx, my, mz, best)
                        two = _entry(box, node, 6, px, py, pz, jx, jy, jz, mx, my, mz, best)
                        if one == np.inf and two == np.inf:
                            node = EMPTY
                        elif two == np.inf:
                            node = child[node, 0]
                        elif one == np.inf:
                            node = child[node, 1]
                        else:
                            later = 1 if one <= two else 0
                            deep[below] = child[node, later]
                            deep_near[below] = max(one, two)
                            below += 1
                            node = child[node, 1 - later]
                    leaf = -1 - node
                    for i in range(leaf // SCALE, leaf // SCALE + leaf % SCALE):
                        az = np.float64(corners[i, 0, kz]) - p2
                        ax = np.float64(corners[i, 0, kx]) - p0 - sx * az
                        ay = np.float64(corners[i, 0, ky]) - p1 - sy * az
                        bz = np.float64(corners[i, 1, kz]) - p2
                        bx = np.float64(corners[i, 1, kx]) - p0 - sx * bz
                        by = np.float64(corners[i, 1, ky]) - p1 - sy * bz
                        cz = np.float64(corners[i, 2, kz]) - p2
                        cx = np.float64(corners[i, 2, kx]) - p0 - sx * cz
                        cy = np.float64(corners[i, 2, ky]) - p1 - sy * cz
                        u = cx * by - cy * bx
                        v = ax * cy - ay * cx
                        w = bx * ay - by * ax
                        if (u < 0.0 or v < 0.0 or w < 0.0) and (u > 0.0 or v > 0.0 or w > 0.0):
                            continue
                        det = u + v + w
                        if det == 0.0:
                            continue
                        t = (u * az + v * bz + w * cz) * sz / det
                        if not 0.0 < t <= best:
                            continue
                        own, face = thing + shift, np.int64(number[i])
                        if (
                            t == best
                            and best_instance >= 0
                            and (
                                own > best_instance
                                or (own == best_instance and face >= best_triangle)
                            )
                        ):
                            continue
                        m = texture[i]
                        if m >= 0:
                            s = (u * uv[i, 0, 0] + v * uv[i, 1, 0] + w * uv[i, 2, 0]) / det
                            r = (u * uv[i, 0, 1] + v * uv[i, 1, 1] + w * uv[i, 2, 1]) / det
                            rows, columns = mask_size[m, 0], mask_size[m, 1]
                            column = min(int((s - np.floor(s)) * columns), columns - 1)
                            row = rows - 1 - min(int((r - np.floor(r)) * rows), rows - 1)
                            if not mask_bits[mask_start[m] + row * columns + column]:
                                continue
                        best, best_instance, best_triangle = t, own, face
                        u_out[ray], v_out[ray] = v / det, w / det
                        back[ray] = det < 0.0
        distance[ray] = best
        instance[ray] = best_instance
        triangle[ray] = best_triangle


@compiled
def face_normals(
    first: Any, row: Any, corners: Any, mesh: Any, inverse: Any, shift: int,
    instance: Any, triangle: Any, directions: Any, found: Any,
) -> None:  # fmt: skip
    """Write the (r, 3) unit normals of triangles against the rays that met them."""
    e, f, n = np.empty(3), np.empty(3), np.empty(3)
    for ray in range(len(instance)):
        thing = instance[ray] - shift
        if thing < 0 or thing >= len(mesh):
            continue
        i = row[first[mesh[thing]] + triangle[ray]]
        for k in range(3):
            e[k] = np.float64(corners[i, 1, k]) - np.float64(corners[i, 0, k])
            f[k] = np.float64(corners[i, 2, k]) - np.float64(corners[i, 0, k])
        x = e[1] * f[2] - e[2] * f[1]
        y = e[2] * f[0] - e[0] * f[2]
        z = e[0] * f[1] - e[1] * f[0]
        against = 0.0
        for k in range(3):  # normals go the way back, transposed
            n[k] = inverse[thing, 0, k] * x + inverse[thing, 1, k] * y + inverse[thing, 2, k] * z
            against += n[k] * directions[ray, k]
        size = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
        if against > 0.0:
            size = -size
        if size != 0.0:
            for k in range(3):
                found[ray, k] = n[k] / size
