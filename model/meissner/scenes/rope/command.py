"""``meissner train-rope``: tables I to IV's counterparts of training, and the forest as F.json."""

from pathlib import Path

import numpy as np

from meissner.forest import file
from meissner.forest.sklearn import of_model
from meissner.rope import labels, train
from meissner.rope.published import TABLE_3, TABLE_4, TABLE_4_MEAN
from meissner.scenes import load
from meissner.scenes.results import table
from meissner.scenes.rope import judge
from meissner.scenes.rope.scene import simulate_all, training
from meissner.scenes.timed import TimedEngine


def _percent(share):
    return "–" if share is None else f"{100 * share:.1f}"


def tables(scene, seed, trees, progress=iter):
    """(the forest of the scene's pattern, rows of tables II, III and IV, remarks)."""
    recordings = training(scene, seed)
    data = train.Data(recordings, seed)
    second, third, forest = [], [], None
    for name, pattern in progress([*labels.PATTERNS.items()]):
        (x, y), (held_x, held_y) = data.split(pattern)
        model = train.fit(x, y, seed, trees)
        both = np.concatenate([y, held_y])
        counts = int((both == 0).sum()), int((both == 1).sum())
        second.append(
            {
                **{"pattern": name, **pattern._asdict()},
                **{f"label {k}": f"{counts[k]} ({labels.COUNTS[name][k]})" for k in (0, 1)},
            }
        )
        test_x, test_y = data.rows(pattern, labels.testing)
        for part, (of_x, of_y) in (("validation", (held_x, held_y)), ("test", (test_x, test_y))):
            found = train.measures(of_y, model.predict(of_x))
            cells = zip(train.MEASURES, found, TABLE_3[name, part])
            third.append({"pattern": name, "data": part} | {k: f"{_percent(v)} ({p})" for k, v, p in cells})
        forest = model if pattern == scene.pattern else forest
    flat = simulate_all(scene, range(seed, seed + scene.seeds), seed)
    _, summary, fourth = judge.real_time(scene, TimedEngine("float", scene.features), forest, flat)
    for row, (steps, ms) in zip(fourth, TABLE_4):
        row["published"] = f"{steps:g} ({ms:g} ms)"
    quiet = sum(section.slip is None for one in recordings for section in one.sections)
    remarks = [
        f"{len(recordings)} recordings, {2 * len(recordings)} sections, {quiet} without slip; "
        f"{data.slipping} slipping and {len(data.rest) - data.slipping} others in the training set",
        *(
            f"published, {what}: {whole}, remainder {rest}"
            for what, (whole, rest) in labels.remainders().items()
        ),
        f"first alarm from t_s: {summary['apart_ms']:+.1f} ± {summary['apart_ms_deviation']:.1f} ms",
        "published: {:+.1f} ± {:.1f} ms, but its 14 printed rows give {:+.1f} ± {:.1f} ms".format(
            *TABLE_4_MEAN, *(of([ms for _, ms in TABLE_4]) for of in (np.mean, np.std))
        ),
    ]
    return forest, second, third, fourth, remarks


def command(arguments):
    """``meissner train-rope``."""
    if arguments.seed < 0:
        raise ValueError(f"seed = {arguments.seed} must not be negative")
    if not 1 <= arguments.trees <= 1000:
        raise ValueError(f"trees = {arguments.trees} must lie in 1 .. 1000")
    if arguments.out is not None:
        file.check_out(arguments.out)
    scene = load("rope_pull")
    forest, second, third, fourth, remarks = tables(scene, arguments.seed, arguments.trees)
    print("simulated ropes; published values in brackets")
    for title, rows in (("table II", second), ("table III (%)", third), ("table IV", fourth)):
        print(f"\n{title}", *table(rows), sep="\n")
    print("", *remarks, sep="\n")
    if arguments.out is not None:
        file.write(Path(arguments.out), of_model(forest, True))
        print(f"the forest of pattern {scene.world['pattern']}: {arguments.out}")
