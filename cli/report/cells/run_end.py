# %% origin [markdown]
# ## How this was made

# %% origin
rows = [("data set", info["title"]), ("data file", info["data_file"]), ("data hash", info["data_hash"]),
        ("seed", info["seed"]),
        ("stopped because", tidy(f"{info['stop_reason'].replace('_', ' ')} ({info['stop_test']})")),
        ("counts", f"{info['evaluations']} evaluations, {info['iterations']} iterations, {info['failures']} failures"),
        ("cost", f"{number(info['cost'], 5)} ({info['objective']})"), ("time", duration(info["seconds"])),
        ("run file", RUN_FILE), ("version", f"sinew {info['version']}")]
settings = "".join(f"<details><summary>settings as used</summary><pre>{escape(text)}</pre></details>"
                   for text in texts("/run/config") if text.strip())
display(HTML('<table class="origin"><tbody>' + "".join(
    f"<tr><th>{escape(key)}</th><td>{escape(str(value))}</td></tr>" for key, value in rows if str(value))
    + "</tbody></table>" + settings))
