"""Which of the runs that were found count: docs/format.md, "Selection"."""


def select(runs):
    """Numbers of the chosen runs, ascending. `runs`: (intervals, rank of its hashes) of each."""
    best = {}
    for i, (intervals, rank) in enumerate(runs):
        if intervals not in best or rank < runs[best[intervals]][1]:
            best[intervals] = i
    order = sorted(best, key=lambda intervals: (intervals[-1][1], intervals[0][0], intervals))
    samples = lambda intervals: sum(end - first for first, end in intervals)
    within = lambda a, b: all(any(f <= first and end <= e for f, e in b) for first, end in a)
    common = lambda a, b: any(first < e and f < end for first, end in a for f, e in b)
    chosen = []
    gapped = [c for c in order if len(c) > 1 and not any(within(c, other) for other in order if other != c)]
    for coverage in sorted(gapped, key=samples, reverse=True):
        if not any(common(coverage, other) for other in chosen):
            chosen.append(coverage)
    free = [c for c in order if len(c) == 1 and not any(common(c, other) for other in chosen)]
    sets = [[]]
    for j, coverage in enumerate(free):
        p = sum(other[0][1] <= coverage[0][0] for other in free[:j])
        worth = lambda those: (sum(map(samples, those)), -len(those))
        sets.append(max(sets[j], sets[p] + [coverage], key=worth))  # of equals the first
    return sorted(best[coverage] for coverage in chosen + sets[-1])
