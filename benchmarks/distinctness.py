"""Measure how well the building generators differ by their looks.

    python benchmarks/distinctness.py [--train 60] [--test 60]

Trains linear discriminants (one Gaussian per generator, one shared covariance) on descriptors of
silhouette, facade, roof and colour (`cityx.checks.descriptors`), and tests them on other seeds.
"""

from __future__ import annotations

import argparse
from collections import Counter

import numpy as np

from cityx.building.catalogue import NAMES, generators
from cityx.building.design import design
from cityx.building.facade.facade import facade
from cityx.building.samples import sample_city, sheet_of
from cityx.building.shell import shell
from cityx.checks.descriptors import classified, descriptors


def described(names: list[str], seeds: range) -> tuple[np.ndarray, np.ndarray]:
    """Build samples and describe them: (n, d) numbers and (n,) rows of `names`."""
    samples = sheet_of(names, seeds, spacing=200.0)
    city = facade(shell(design(sample_city(samples))))
    ids, table = descriptors(city)
    label = {sample.id: names.index(sample.generator) for sample in samples}
    return table, np.array([label[int(number)] for number in ids])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--train", type=int, default=60)
    parser.add_argument("--test", type=int, default=60)
    options = parser.parse_args()
    names = list(NAMES)
    train = described(names, range(1000, 1000 + options.train))
    table, label = described(names, range(5000, 5000 + options.test))
    found = classified(*train, table)
    for number, name in enumerate(names):
        own = found[label == number]
        wrong = Counter(names[i] for i in own.tolist() if i != number).most_common(2)
        missed = ", ".join(f"{word} {count}" for word, count in wrong)
        print(f"{generators()[name].title:32s} {np.mean(own == number):6.1%}  {missed}")
    print(f"{len(names)} generators told apart: {np.mean(found == label):.1%} of {len(label)}")


if __name__ == "__main__":
    main()
