# What tools/windows packs: program, library, documents and licences.
install(TARGETS mbk RUNTIME DESTINATION . COMPONENT program)
install(FILES README.md LICENSE CITATION.cff CHANGELOG.md THIRD_PARTY_NOTICES.md packaging/copyright DESTINATION .
        COMPONENT program)
install(DIRECTORY docs examples DESTINATION . COMPONENT program PATTERN docs/site EXCLUDE)
install(DIRECTORY ${MBK_STATIC}/licences DESTINATION . COMPONENT program)
install(FILES ${MBK_STATIC}/sources.tsv DESTINATION licences COMPONENT program)
