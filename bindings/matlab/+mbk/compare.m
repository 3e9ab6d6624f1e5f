function [result, info] = compare(varargin)
% mbk.compare  What changed between two results: how far M, B and K are apart.
%
%   RESULT = mbk.compare(...) is the document that 'mbk compare --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.compare(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.compare(INFO1, INFO2, ...)          second outputs of mbk.measure
%   [...] = mbk.compare({'a.json', 'b.json'}, ...)  files: results, or recordings
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
%   See also mbk.measure
  [result, info] = mbk.internal.run('compare', varargin);
end
