#!/bin/sh
# Backups, and the two ends of a restore; between them `make restore` has the service bring the new database up to date.
# PGHOST, PGUSER and PGPASSWORD say where the database is.
#   backup.sh save           write a backup into this folder and print its name
#   backup.sh unpack NAME    read a backup into a new database beside the one in use
#   backup.sh swap           put the new database in its place, and keep the old one
#   backup.sh give_up WHY    remove the new database, and fail
set -eu
database=hpn
new=hpn_restored

refuse() {
    echo "$1" >&2
    exit 1
}

ask() {
    psql --no-psqlrc --quiet --tuples-only --no-align --set=ON_ERROR_STOP=1 --dbname="$1" --command="$2"
}

drop() {
    dropdb --if-exists "$new" 2>/dev/null || refuse "the unfinished database $new is in use; once it is not: dropdb $new"
}

# Nothing has changed for the service, so nothing is left behind either.
give_up() {
    drop
    refuse "$1; nothing has changed"
}

require_unused() {
    users=$(ask postgres "SELECT count(*) FROM pg_stat_activity WHERE datname = '$database' AND backend_type = 'client backend'")
    [ "$users" = 0 ] || refuse "the database is in use by $users connections: docker compose stop web, and end what else uses it"
}

save() {
    name=hpn-$(date -u +%Y%m%dT%H%M%SZ).dump
    pg_dump --format=custom --no-owner --file="$name.part" "$database"
    mv "$name.part" "$name" # under its name only once it is whole
    echo "$name"
}

unpack() {
    [ -f "$1" ] || refuse "there is no backup $1; docker compose run --rm backup ls lists them"
    require_unused
    drop
    createdb --template=template0 "$new"
    pg_restore --single-transaction --exit-on-error --no-owner --dbname="$new" "$1" || give_up "$1 can't be restored"
    known=$(ask "$new" "SELECT to_regclass('public.alembic_version') IS NOT NULL")
    [ "$known" = t ] || give_up "$1 is no backup of HPN Select"
}

# Both names change in one transaction, or none.
swap() {
    old=${database}_$(date -u +%Y%m%dt%H%M%Sz)
    ask postgres "BEGIN; ALTER DATABASE $database RENAME TO $old; ALTER DATABASE $new RENAME TO $database; COMMIT" \
        || give_up "the backup can't take the database's place"
    echo "restored; the database from before is kept as $old"
}

"$@"
