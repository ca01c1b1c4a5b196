import grimp

PACKAGE = "cityx"


def circles(graph):
    """Groups of modules that import each other, by Tarjan's algorithm without recursion."""
    index, low, stack, held, found = {}, {}, [], set(), []
    for root in graph:
        work = [] if root in index else [(root, iter(graph[root]))]
        while work:
            node, ahead = work[-1]
            if node not in index:
                index[node] = low[node] = len(index)
                stack.append(node)
                held.add(node)
            after = next(ahead, None)
            if after is None:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    group = stack[stack.index(node) :]
                    del stack[stack.index(node) :]
                    held -= set(group)
                    found += [group] if len(group) > 1 else []
            elif after not in index:
                work.append((after, iter(graph[after])))
            elif after in held:
                low[node] = min(low[node], index[after])
    return found


def test_a_circle_is_found_and_a_chain_is_none():
    assert [sorted(c) for c in circles({"a": ["b"], "b": ["c"], "c": ["a"], "d": ["a"]})] == [
        ["a", "b", "c"]
    ]
    assert circles({"a": ["b", "c"], "b": ["c"], "c": []}) == []


def test_no_modules_import_each_other():
    made = grimp.build_graph(PACKAGE, cache_dir=None)
    graph = {m: sorted(made.find_modules_directly_imported_by(m)) for m in sorted(made.modules)}
    assert len(graph) > 500
    assert circles(graph) == []
