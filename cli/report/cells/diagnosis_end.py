# %% origin [markdown]
# ## How this was made

# %% origin
rows = [("data set", info["title"]), ("data file", info["data_file"]), ("data hash", info["data_hash"]),
        ("seed", info["seed"]),
        ("base fit", tidy(f"{info['stop_reason'].replace('_', ' ')} ({info['stop_test']})")),
        ("objective", info["objective"]), ("alarm level", percent(about["alarm_level"])),
        ("time", duration(info["seconds"])), ("diagnosis file", RUN_FILE), ("version", f"sinew {info['version']}")]
rows += [(f"{test['test']}, {test['channel']}", f"{number(test['statistic'])} ({chance(test['p_value'])})")
         for test in rows_of("tests")]
settings = "".join(f"<details><summary>settings as used</summary><pre>{escape(text)}</pre></details>"
                   for text in texts("/run/config") if text.strip())
display(HTML('<table class="origin"><tbody>' + "".join(
    f"<tr><th>{escape(key)}</th><td>{escape(str(value))}</td></tr>" for key, value in rows if str(value))
    + "</tbody></table>" + settings))
