#!/bin/sh
# Checks a certificate and its key, and copies them to where the proxy reads them: `make certificates FROM=folder`.
# The folder has fullchain.pem and privkey.pem, which may be links, as letsencrypt makes them.
set -eu
from=$1
to=certificates
proxy=101 # its user and group in docker-compose.yml

refuse() {
    echo "$1" >&2
    exit 1
}

for file in fullchain.pem privkey.pem; do
    [ -r "$from/$file" ] || refuse "$from/$file is missing, or $(id -un) can't read it"
done
certified=$(openssl x509 -in "$from/fullchain.pem" -noout -pubkey 2>/dev/null) \
    || refuse "$from/fullchain.pem must begin with a certificate in PEM"
public=$(openssl pkey -in "$from/privkey.pem" -passin pass: -pubout 2>/dev/null) \
    || refuse "$from/privkey.pem must be a key in PEM without a passphrase"
[ "$certified" = "$public" ] \
    || refuse "$from/privkey.pem is the key of another certificate than the first one in $from/fullchain.pem"
openssl x509 -in "$from/fullchain.pem" -noout -checkend 0 >/dev/null \
    || refuse "$from/fullchain.pem has expired: $(openssl x509 -in "$from/fullchain.pem" -noout -enddate)"
[ "$(id -u)" = 0 ] || refuse "both are right, but only root can give the key to user $proxy: sudo make certificates FROM=$from"

install -d -m 0755 "$to"
install -m 0644 "$from/fullchain.pem" "$to/fullchain.pem.new"
install -m 0400 -o $proxy -g $proxy "$from/privkey.pem" "$to/privkey.pem.new"
mv "$to/fullchain.pem.new" "$to/fullchain.pem" # also where it stands there as a link
mv "$to/privkey.pem.new" "$to/privkey.pem"
openssl x509 -in "$to/fullchain.pem" -noout -subject -enddate
