"""Several models on the same data, compared by their error on data that none has seen."""

import hysid


def report() -> str:
    train, test = hysid.specimen("terfenol-rod").data()
    comparison = hysid.compare(
        train.x,
        train.y,
        train.time,
        records=train.records,
        test={"x": test.x, "y": test.y, "time": test.time, "records": test.records},
        models=["masing", "prandtl-ishlinskii", "modified-prandtl-ishlinskii"],
        seed=1,
    )
    return "".join(f"{row.name}: {row.test.rmse:.4f}\n" for row in comparison)


if __name__ == "__main__":
    print(report(), end="")
