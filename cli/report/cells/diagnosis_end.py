# %% words [markdown]
# ## Words on this page

# %% words
WORDS = [("base model", "the model as it was fitted, every effect of the library switched off"),
         ("cause", "an effect of the library that, added and fitted, reduces the error beyond chance"),
         ("resample", "the parts of the data that are left out of the fit in turn, drawn again with replacement"),
         ("could also be", "an effect that these data do not distinguish from a named cause; the page names an experiment that would"),
         ("noise floor", "the error that the noise alone would leave: as stated by the data, or estimated"),
         ("p", "the chance of an alarm as strong as this, by anything in the whole list, without any misfit"),
         ("ΔLR, ΔBIC", "drop of twice the negative log-likelihood, without and with a charge for every parameter more; ΔBIC "
          "above 10 is strong evidence"),
         ("bias", "how far the base model over- or underestimated a parameter without the cause"),
         ("noticed above", "the size from which an effect would have raised the alarm in 95 of 100 such data sets"),
         ("R²", "share of the measured signal's variance that the model reproduces")]
display(HTML('<table class="origin"><tbody>' + "".join(
    f"<tr><th>{escape(word)}</th><td>{escape(meaning)}</td></tr>" for word, meaning in WORDS) + "</tbody></table>"))

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
