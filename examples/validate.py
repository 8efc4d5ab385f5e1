"""The error on new data, estimated by cross-validation: the model is fitted without one part of the data and simulates
that part."""

import hysid


def report() -> str:
    rod, _ = hysid.specimen("terfenol-rod").data()
    validation = hysid.validate(
        rod.x, rod.y, rod.time, records=rod.records, model="prandtl-ishlinskii", operators=12
    )

    text = ""
    for fold in validation.folds:
        text += f"{fold.held_out}: training error {fold.train.rmse:.4f}, unseen error {fold.unseen.rmse:.4f}\n"
    return text + f"all that was held out: {validation.unseen.rmse:.4f}\n"


if __name__ == "__main__":
    print(report(), end="")
