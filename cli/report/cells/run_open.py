# %% the run file
# The path counts from the folder of this notebook. Point it at another run file, or change it if the notebook
# or the file moves, and run all cells again: nothing below names the data. What the file holds: docs/run_file.md.
RUN_FILE = "{{RUN_FILE}}"

run = h5py.File(RUN_FILE, "r")
info = {key: value.decode() if isinstance(value, bytes) else value for key, value in run["/run"].attrs.items()}


def texts(path):
    """The texts at a path of the run file; none if it is absent."""
    return text_list(run[path]) if path in run else []


def children(path):
    """The names in a group; none if it is absent."""
    return in_order(run[path]) if path in run else []


def table_of(group):
    """The columns of a group, as {name: {column: entry}}."""
    if group not in run:
        return {}
    columns = {key: text_list(node) if h5py.check_string_dtype(node.dtype) else node[()]
               for key, node in run[group].items()}
    count = len(columns["name"])
    columns = {key: column for key, column in columns.items() if np.shape(column) == (count,)}
    return {name: {key: column[i] for key, column in columns.items()} for i, name in enumerate(columns["name"])}
