"""From columns of measured data to a model file: fit, error on data that the model has not seen, save, load."""

import hysid


def report() -> str:
    # In place of measured arrays: hysid.fit(x, y, t), or columns of a pandas table.
    train, test = hysid.specimen("ferromagnet").data()

    # Without `model`, all models are cross-validated; one named model is quicker.
    model = hysid.fit(train.x, train.y, train.time, records=train.records, model="preisach", seed=1)
    loaded = hysid.Model.from_json(model.to_json())

    unseen = loaded.evaluate(test.x, test.y, test.time, records=test.records)
    return (
        f"{loaded.name} with {loaded.parameters} parameters\n"
        f"unseen error {unseen.nrmse_std_percent:.3f} % of the standard deviation\n"
    )


if __name__ == "__main__":
    print(report(), end="")
