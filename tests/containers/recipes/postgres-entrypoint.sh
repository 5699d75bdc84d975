# The part of the real image's start that the compose file needs: an empty volume becomes a database with user and password.
set -eu
if [ "$1" = postgres ] && [ ! -s "$PGDATA/PG_VERSION" ]; then
    : "${POSTGRES_PASSWORD:?}"
    file=$(mktemp)
    printf '%s\n' "$POSTGRES_PASSWORD" > "$file"
    # shellcheck disable=SC2086 -- words of an option
    initdb --username="${POSTGRES_USER:-postgres}" --pwfile="$file" ${POSTGRES_INITDB_ARGS:-}
    rm "$file"
    printf '\nhost all all all scram-sha-256\n' >> "$PGDATA/pg_hba.conf"
    pg_ctl -D "$PGDATA" -o "-c listen_addresses=''" -w start
    PGPASSWORD=$POSTGRES_PASSWORD psql -U "$POSTGRES_USER" -d postgres -v ON_ERROR_STOP=1 -c "CREATE DATABASE \"$POSTGRES_DB\""
    pg_ctl -D "$PGDATA" -m fast -w stop
    set -- postgres -c "listen_addresses=*"
elif [ "$1" = postgres ]; then
    shift
    set -- postgres -c "listen_addresses=*" "$@"
fi
exec "$@"
