function [result, info] = compare(varargin)
% mbk.compare  Difference between two results in M, B and K.
%
%   RESULT = mbk.compare(...) returns the JSON document of 'mbk compare --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.compare(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.compare(INFO1, INFO2, ...)          second outputs of mbk.measure
%   [...] = mbk.compare({'a.json', 'b.json'}, ...)  files: results, or recordings
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
%   See also mbk.measure
  [result, info] = mbk.internal.run('compare', varargin);
end
