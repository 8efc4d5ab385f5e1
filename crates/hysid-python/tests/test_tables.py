"""Tables of polars and xarray in and out, columns by their names, and what is refused."""

import numpy as np
import pandas
import polars
import pytest
import xarray

import hysid

SMALL = {"model": "masing", "thresholds": [0.5, 1.0, 2.0]}


@pytest.fixture(scope="module")
def known(spring_and_slider):
    """The columns, and a model of them with names and units."""
    x, y = spring_and_slider
    time = 0.1 * np.arange(len(x))
    return x, y, time, hysid.fit({"H [A/m]": x}, {"B [T]": y}, {"t [s]": time}, **SMALL)


def of_xarray(x, y, time):
    rows = {"dims": "t", "coords": {"t": ("t", time, {"units": "s"})}}
    field = xarray.DataArray(x, name="H", attrs={"units": "A/m"}, **rows)
    return field, xarray.DataArray(y, name="B", attrs={"units": "T"}, **rows)


def test_polars_comes_in_and_out_with_its_names(known):
    x, y, time, model = known
    frame = polars.DataFrame({"H [A/m]": x, "B [T]": y, "t [s]": time})
    fitted = hysid.fit(frame["H [A/m]"], frame["B [T]"], frame["t [s]"], **SMALL)
    assert fitted == model
    for given in (frame["H [A/m]"], frame.select("H [A/m]"), frame):
        series = model.simulate(given)
        assert isinstance(series, polars.Series) and series.name == "B [T]_model"
        assert np.array_equal(series.to_numpy(), model.simulate(x))
    assert model.evaluate(frame["H [A/m]"], frame["B [T]"]) == model.evaluate(x, {"B [T]": y})
    blank = frame["B [T]"].to_list()
    blank[3] = None
    assert hysid.fit(frame["H [A/m]"], polars.Series("B [T]", blank), **SMALL).train.samples == len(x) - 1
    drive = model.invert(frame["B [T]"])
    assert isinstance(drive.input, polars.Series) and drive.input.name == "H [A/m]"
    with pytest.raises(ValueError, match=r"a lazy table has no numbers yet \(collect it"):
        hysid.fit(frame.lazy(), y)


def test_polars_dates_are_seconds(known):
    x, y, time, model = known
    start = np.datetime64("2024-03-01T12:00:00")
    stamps = polars.Series("t", start + (1000 * time).round().astype("timedelta64[ms]"))
    fitted = hysid.fit({"H [A/m]": x}, {"B [T]": y}, stamps, **SMALL)
    assert fitted.description["columns"]["time"] == "t [s]" and fitted == model


def test_xarray_comes_in_and_out_with_coordinates_and_units(known):
    x, y, time, model = known
    field, density = of_xarray(x, y, time)
    assert hysid.fit(field, density, field.t, **SMALL) == model
    found = model.simulate(field)
    assert isinstance(found, xarray.DataArray) and found.name == "B_model"
    assert found.attrs == {"units": "T"} and found.t.identical(field.t) and found.dims == ("t",)
    assert np.array_equal(found.to_numpy(), model.simulate(x))
    table = xarray.Dataset({"H": field, "B": density})
    assert hysid.fit(table, "B", time="t", **SMALL) == model
    assert model.simulate(table).identical(found), "the input is taken by its name"
    wide = xarray.concat([field.drop_attrs(), 2 * field.drop_attrs()], dim="place").transpose("t", "place")
    two = hysid.fit(wide, density, model="xpnn+", stops=2, hidden=2, starts=1, epochs=2, relaxation=0)
    assert two.simulate(wide).dims == ("t",) and two.simulate(wide).t.equals(field.t)


def test_units_of_attributes_are_converted_or_refused(known):
    x, y, time, model = known
    field, density = of_xarray(x, y, time)
    kilo = (field / 1000).assign_attrs(units="kA/m")
    with pytest.warns(hysid.HysidWarning, match=r"H \[kA/m\] is converted to the unit of the model's H \[A/m\]"):
        assert np.allclose(model.simulate(kilo), model.simulate(x), rtol=0, atol=1e-9)
    unnamed = hysid.fit(field.rename(None), density.rename(None), **SMALL)
    assert (unnamed.inputs, unnamed.output) == (["x [A/m]"], "y [T]")
    plain = hysid.fit(field.assign_attrs(units="1"), density.assign_attrs(units=""), **SMALL)
    assert (plain.inputs, plain.output) == (["H"], "B")
    same = hysid.fit(field.rename("H_A_per_m"), density, **SMALL)
    assert same.inputs == ["H_A_per_m"]
    with pytest.raises(ValueError, match="H_kA_per_m: its name has the unit kA/m, and its attribute units is A/m"):
        hysid.fit(field.rename("H_kA_per_m"), density)


def test_labels_of_rows_must_agree(known):
    x, y, time, _ = known
    field, density = of_xarray(x, y, time)
    with pytest.raises(ValueError, match=r"x and y have different indexes.*y\.reindex_like\(x\)"):
        hysid.fit(field, density.assign_coords(t=time + 1.0))
    backwards = slice(None, None, -1)
    with pytest.warns(hysid.HysidWarning, match="not in the order of their index"):
        hysid.fit(field[backwards], density[backwards], **SMALL)


@pytest.mark.parametrize("library", [pandas.DataFrame, polars.DataFrame, dict])
def test_a_column_record_has_the_labels_and_other_text_is_named(known, library):
    x, y, time, _ = known
    labels = np.repeat(["a", "b"], 300)
    named = {"t [s]": time, "H [A/m]": x, "B [T]": y}
    table = library({"record": labels, **named})
    model = hysid.fit(table, "B [T]", time="t [s]", **SMALL)
    assert model == hysid.fit(table, "B [T]", time="t [s]", records="record", **SMALL)
    assert model.evaluate(table, "B [T]") == model.evaluate(table, "B [T]", records="record")
    with pytest.raises(ValueError, match="input 'operator': .*labels of records are given as records"):
        hysid.fit(library({"operator": labels, **named}), "B [T]", time="t [s]")


@pytest.mark.parametrize("library", [pandas.DataFrame, polars.DataFrame, dict])
def test_columns_are_given_by_their_names(known, library):
    x, y, time, model = known
    labels = np.repeat(["a", "b"], 300)
    table = library({"t [s]": time, "H [A/m]": x, "B [T]": y, "test": labels})
    by_name = hysid.fit(table, "B [T]", time="t [s]", records="test", **SMALL)
    by_column = hysid.fit({"H [A/m]": x}, {"B [T]": y}, {"t [s]": time}, records=labels, **SMALL)
    assert by_name == by_column and by_name.inputs == ["H [A/m]"]
    outputs = by_name.simulate(table, time="t [s]", records="test")
    assert np.array_equal(np.asarray(outputs), by_column.simulate(x, records=labels))
    found = by_name.evaluate(table, "B [T]", time="t [s]", records="test")
    assert found == by_column.evaluate(x, {"B [T]": y}, records=labels)
    diagnosis = hysid.diagnose(table, "B [T]", time="t [s]", records="test")
    named = ({"H [A/m]": x}, {"B [T]": y}, {"t [s]": time})
    assert str(diagnosis) == str(hysid.diagnose(*named, records=labels))
    with pytest.raises(ValueError, match="y: x has no column 'force'"):
        hysid.fit(table, "force")
    with pytest.raises(ValueError, match="time 't': a name is that of a column of x, and x is no table"):
        hysid.fit(x, y, time="t")


def test_cycles_warn_of_a_charge_that_begins_anew():
    charge = np.tile(np.linspace(0, 2500, 40), 6)
    rising = 3.2 + 0.8 * np.linspace(0, 1, 40)
    voltage = np.tile(np.concatenate([rising + 0.03, rising[::-1] - 0.03]), 3)
    with pytest.warns(hysid.HysidWarning, match="the charge begins anew in each half cycle"):
        table = hysid.cycles({"Capacity (mAh)": charge}, {"Voltage (V)": voltage})
    assert table.notes[0].startswith("the charge begins anew") and len(table["width"]) == 3
    assert np.allclose(table["width"], 0.06)
