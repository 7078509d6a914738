#!/bin/sh
# keep_warnings.sh COMPILER ... -o OBJECT ...: compiles, and leaves what the compiler said in OBJECT.warnings, of which
# there is none if it said nothing. ./check reads them (refuse_warnings in steps.sh).
object=
previous=
for word in "$@"; do
  [ "$previous" = -o ] && object=$word
  previous=$word
done
[ -n "$object" ] || exec "$@"
"$@" 2>"$object.warnings"
status=$?
if [ -s "$object.warnings" ]; then
  cat "$object.warnings" >&2
else
  rm -f "$object.warnings"
fi
exit $status
