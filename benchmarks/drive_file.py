"""A data set of the problem `drive` (docs/dataset_file.md): a torque or force that is recorded with noise of a stated level, and a position."""
import h5py


def write(path, title, source, records, driven, position_unit, constants=()):
    """@param records per trial: times, recorded input, read position; the last one is held out
    @param driven name, unit and noise level of the input @param constants name, value, unit of each"""
    with h5py.File(path, "w") as out:
        out.attrs.update(sinew_schema="dataset/1", title=title, subject="", licence="CC0", source=source, synthetic=1)
        for name, value, unit in constants:
            out["constants/" + name] = value
            out["constants/" + name].attrs["unit"] = unit
        channel, unit, sigma = driven
        for number, (time, push, position) in enumerate(records, 1):
            held_out = number == len(records)
            trial = out.create_group("trials/" + ("held_out" if held_out else f"record_{number}"))
            trial.attrs.update(role="validate" if held_out else "train", task="moves")
            grid = trial.create_group("joint")
            grid["time"] = time
            grid["channels/" + channel] = push
            grid["channels/" + channel].attrs.update(unit=unit, kind="input", sigma=sigma)
            grid["channels/position"] = position
            grid["channels/position"].attrs.update(unit=position_unit, kind="measured")
