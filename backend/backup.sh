#!/bin/sh
# Backups, and the two ends of a restore; between them `make restore` has the service bring the new database up to date.
# PGHOST, PGUSER and PGPASSWORD say where the database is.
#   backup.sh save           write a backup into this folder and print its name
#   backup.sh keep           the same, and keep the newest BACKUP_KEEP alone
#   backup.sh schedule       write one whenever the newest is older than BACKUP_HOURS, and keep the newest BACKUP_KEEP
#   backup.sh has_recent     fail where the newest is older than that and an hour
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
    pg_dump --format=custom --no-owner --file="$name.part" "$database" || return
    mv "$name.part" "$name" || return # under its name only once it is whole
    echo "$name"
}

# A backup that is younger than so many minutes.
younger() {
    find . -maxdepth 1 -name 'hpn-*.dump' -mmin "-$1" | head -n 1
}

has_recent() {
    [ -n "$(younger $((BACKUP_HOURS * 60 + 60)))" ] || refuse "no backup of the last $BACKUP_HOURS hours"
}

# Only after a new one, so that a database that can't be read costs no backup; and what a kill left unfinished.
prune() {
    find . -maxdepth 1 -name 'hpn-*.dump.part' -mmin +1440 -exec rm -f {} +
    ls -1r | grep '^hpn-.*\.dump$' | tail -n "+$((BACKUP_KEEP + 1))" | while read -r name; do
        rm -f "$name"
        echo "removed $name"
    done
}

keep() {
    save && prune
}

schedule() {
    [ "$BACKUP_HOURS" -ge 1 ] && [ "$BACKUP_KEEP" -ge 1 ] || refuse "BACKUP_HOURS and BACKUP_KEEP must be whole numbers from 1"
    trap 'exit 0' TERM INT
    while :; do
        if [ -z "$(younger $((BACKUP_HOURS * 60)))" ]; then
            keep || echo "no backup could be written; the next try is in ${BACKUP_SECONDS:-60} s" >&2
        fi
        sleep "${BACKUP_SECONDS:-60}" &
        wait $!
    done
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
